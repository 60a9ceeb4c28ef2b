// finds: nothing
#include <assert.h>
#include <threads.h>

static mtx_t lock;
static int count;

static int work(void*) {
  mtx_lock(&lock);
  const int seen = ++count;
  mtx_unlock(&lock);
  return seen;
}

int main() {
  thrd_t a;
  thrd_t b;
  int first = 0;
  int second = 0;
  mtx_init(&lock, mtx_plain);
  thrd_create(&a, work, nullptr);
  thrd_create(&b, work, nullptr);
  thrd_join(a, &first);
  thrd_join(b, &second);
  assert(first + second == 3);
  return 0;
}
