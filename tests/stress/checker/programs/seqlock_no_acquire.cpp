// finds: failure
#include <atomic>
#include <cassert>
#include <thread>

// Boehm 2012, "Can Seqlocks Get Along With Programming Language Memory Models?".
std::atomic<unsigned> sequence{0};
std::atomic<int> a{0};
std::atomic<int> b{0};

void write() {
  sequence.store(1, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  a.store(1, std::memory_order_relaxed);
  b.store(1, std::memory_order_relaxed);
  sequence.store(2, std::memory_order_release);
}

void read() {
  const unsigned before = sequence.load(std::memory_order_acquire);
  const int x = a.load(std::memory_order_relaxed);
  const int y = b.load(std::memory_order_relaxed);
  if (before % 2 == 0 && sequence.load(std::memory_order_relaxed) == before) assert(x == y);
}

int main() {
  std::thread writer(write);
  std::thread reader(read);
  writer.join();
  reader.join();
  return 0;
}
