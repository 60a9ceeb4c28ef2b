// finds: nothing
#include <assert.h>
#include <pthread.h>
#include <stddef.h>

static pthread_once_t once = PTHREAD_ONCE_INIT;
static int made;

static void make() {
  ++made;
}

static void* work(void* argument) {
  pthread_once(&once, make);
  if (argument != NULL) pthread_exit(argument);
  return NULL;
}

int main() {
  int here = 7;
  pthread_t a;
  pthread_t b;
  void* result = NULL;
  pthread_create(&a, NULL, work, &here);
  pthread_create(&b, NULL, work, NULL);
  pthread_join(a, &result);
  pthread_join(b, NULL);
  assert(result == &here && made == 1);
  return 0;
}
