// finds: failure
// the mutex may still be held, or locked, when it is destroyed
#include <pthread.h>
#include <thread>

pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;

int main() {
  std::thread other([] {
    pthread_mutex_lock(&mutex);
    pthread_mutex_unlock(&mutex);
  });
  pthread_mutex_destroy(&mutex);
  other.join();
  return 0;
}
