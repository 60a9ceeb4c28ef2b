// finds: failure
// the barrier is destroyed although a thread may not have come to it
#include <pthread.h>
#include <thread>

pthread_barrier_t barrier;

int main() {
  pthread_barrier_init(&barrier, nullptr, 1);
  std::thread other([] { pthread_barrier_wait(&barrier); });
  pthread_barrier_destroy(&barrier);
  other.join();
  return 0;
}
