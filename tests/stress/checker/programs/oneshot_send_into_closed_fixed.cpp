// finds: nothing
// tokio#4225 (pull 4226), mended: send marks the value as sent only if the channel is not closed,
// so that the value it takes back stays its own
#include <atomic>
#include <thread>

struct Oneshot {
  static constexpr unsigned sent = 1;
  static constexpr unsigned closed = 2;
  std::atomic<unsigned> state{0};
  int value = 0;

  bool send(int fresh) {
    value = fresh;
    unsigned before = state.load(std::memory_order_relaxed);
    while ((before & closed) == 0)
      if (state.compare_exchange_strong(before, before | sent, std::memory_order_acq_rel))
        return true;
    value = 0;
    return false;
  }

  void close() { state.fetch_or(closed, std::memory_order_acq_rel); }

  int receive_or(int otherwise) {
    if ((state.load(std::memory_order_acquire) & sent) == 0) return otherwise;
    return value;
  }
};

int main() {
  Oneshot channel;
  std::thread sender([&] { channel.send(7); });
  channel.close();
  const int received = channel.receive_or(-1);
  sender.join();
  if (received != -1 && received != 7) return 1;
  return 0;
}
