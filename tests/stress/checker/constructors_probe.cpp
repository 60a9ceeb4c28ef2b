// A global variable whose constructor begins a thread, as loggers and pools do: with an argument
// main() races with it. And two whose order is asked for.

#include <memory>
#include <mutex>
#include <thread>

namespace {

std::mutex mutex;
int steps = 0;

struct Background {
  std::unique_ptr<int> own = std::make_unique<int>(1);
  std::thread worker{[this] {
    const std::scoped_lock lock(mutex);
    steps += *own;
  }};
  Background() = default;
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { worker.join(); }
};
Background background;

int made = 0;
struct Counted {
  int number = ++made;
};
Counted second;
[[gnu::init_priority(200)]] Counted first;

}  // namespace

int main(int argc, char**) {
  std::unique_lock lock(mutex, std::defer_lock);
  if (argc == 1) lock.lock();
  ++steps;
  const bool in_order = first.number == 1 && second.number == 2;
  return in_order && (steps == 1 || steps == 2) ? 0 : 1;
}
