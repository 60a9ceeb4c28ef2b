// finds: nothing
#include <atomic>
#include <cassert>
#include <pthread.h>
#include <stddef.h>

static std::atomic<int> done{0};

static void* work(void*) {
  done.fetch_add(1);
  return NULL;
}

int main() {
  pthread_t thread;
  pthread_create(&thread, NULL, work, NULL);
  pthread_detach(thread);
  pthread_exit(NULL);  // the process goes on until the other has ended
}
