// finds: data race
// tokio#4225 (pull 4226): send marks the value as sent even if the channel is closed, so that the
// receiver reads the value while the sender takes it back
#include <atomic>
#include <thread>

struct Oneshot {
  static constexpr unsigned sent = 1;
  static constexpr unsigned closed = 2;
  std::atomic<unsigned> state{0};
  int value = 0;

  bool send(int fresh) {
    value = fresh;
    const unsigned before = state.fetch_or(sent, std::memory_order_acq_rel);
    if ((before & closed) == 0) return true;
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
