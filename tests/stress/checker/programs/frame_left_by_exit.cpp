// finds: use after return
// pthread_exit takes the variables of all functions that it leaves
#include <atomic>
#include <pthread.h>
#include <thread>

std::atomic<std::atomic<int>*> shown;

void show_and_exit() {
  std::atomic<int> value = 0;
  shown = &value;
  pthread_exit(nullptr);
}

int main() {
  std::thread first(show_and_exit);
  if (std::atomic<int>* value = shown) *value = 1;
  first.join();
  return 0;
}
