// finds with -DWRONG: deadlock
// bshoshany/thread-pool#93 and pull 108: the pool's end sets its flag and notifies without the
// mutex, between a worker's check and its sleep. Right: the pool's end sets its flag under the
// mutex, so that no worker is between its check and its sleep
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

struct Pool {
  std::mutex mutex;
  std::condition_variable changed;
  std::atomic<bool> running{true};
  int jobs = 0;
  int jobs_done = 0;
  std::thread worker{[this] { work(); }};

  void work() {
    while (true) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [this] { return jobs != 0 || !running; });
      if (jobs == 0) return;
      --jobs;
      ++jobs_done;
    }
  }

  ~Pool() {
#if defined(WRONG)
    running = false;
#else
    {
      const std::scoped_lock lock(mutex);
      running = false;
    }
#endif
    changed.notify_all();
    worker.join();
  }
};

int main() {
  Pool pool;
  {
    const std::scoped_lock lock(pool.mutex);
    pool.jobs = 1;
  }
  pool.changed.notify_one();
  return 0;
}
