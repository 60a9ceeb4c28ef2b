// finds with -DWRONG: data race
// tokio#4225 (pull 4226): send marks the value as sent even if the channel is closed, so that the
// receiver reads the value while the sender takes it back. Right: send marks the value as sent
// only if the channel is not closed, so that the value it takes back stays its own
#include <atomic>
#include <thread>

struct Oneshot {
  static constexpr unsigned sent = 1;
  static constexpr unsigned closed = 2;
  std::atomic<unsigned> state{0};
  int value = 0;

  bool send(int fresh) {
    value = fresh;
#if defined(WRONG)
    const unsigned before = state.fetch_or(sent, std::memory_order_acq_rel);
    if ((before & closed) == 0) return true;
#else
    unsigned before = state.load(std::memory_order_relaxed);
    while ((before & closed) == 0)
      if (state.compare_exchange_strong(before, before | sent, std::memory_order_acq_rel))
        return true;
#endif
    value = 0;
    return false;
  }

  void close() {
    state.fetch_or(closed, std::memory_order_acq_rel);
  }

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
