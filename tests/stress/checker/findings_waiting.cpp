// Programs that wait, for what comes and for what does not: locks, loops, sleepers.

#include <atomic>
#include <cassert>
#include <mutex>
#include <thread>

#include "tests/stress/checker/findings_variables.hpp"

namespace irt::findings {

namespace {

void wait_until_ready() {
  std::unique_lock l(m);
  condition.wait(l, [] { return ready; });
}

const Program programs[] = {
    {"deadlock",
     "deadlock",
     {[] {
        const std::lock_guard a(m);
        const std::lock_guard b(n);
      },
      [] {
        const std::lock_guard b(n);
        const std::lock_guard a(m);
      }}},
    {"locks in order",
     "",
     {[] {
        const std::lock_guard a(m);
        const std::lock_guard b(n);
        ++data;
      },
      [] {
        const std::lock_guard a(m);
        const std::lock_guard b(n);
        ++data;
      }}},
    {"waits for nobody",
     "livelock",
     {[] {
        while (x.load(acq) == 0) {
        }
      },
      no_work}},
    {"waits for somebody",
     "",
     {[] {
        while (x.load(acq) == 0) {
        }
      },
      [] { x.store(1, rel); }}},
    {"waits for what was drawn",
     "livelock",
     {[] {
        const int ticket = x.fetch_add(1, rlx);
        while (y.load(acq) != ticket) {
        }
      },
      [] { x.fetch_add(1, rlx); },
      [] {
        const int ticket = x.fetch_add(1, rlx);
        while (y.load(acq) != ticket) {
        }
        y.store(ticket + 1, rel);
      }}},
    {"waits after it has looked elsewhere",
     "livelock",
     {[] {
        if (x.load(rlx) == 0)
          while (y.load(acq) == 0) {
          }
      },
      [] { x.store(1, rlx); }}},
    {"waits, counting, for nobody",
     "livelock",
     {[] {
        for (int i = 0; x.load(acq) == 0; ++i) data = i;
      },
      no_work}},
    {"tries a lock for ever",
     "livelock",
     {[] {
        for (;;) {
          const std::lock_guard l(m);
          if (ready) break;
        }
      },
      no_work}},
    {"looks a thousand times",
     "",
     {[] {
        for (int i = 0; i < 1000 && x.load(acq) == 0; ++i) {
        }
      },
      no_work}},
    // What is wrong shows only if the others are slower than its patience.
    {"gives up after a thousand looks",
     "failure",
     {[] {
        for (int i = 0; i < 1000; ++i)
          if (x.load(acq) != 0) return;
        assert(y.load(rlx) == 1);
      },
      [] { x.store(1, rel); }}},
    {"gives up on the second of two",
     "failure",
     {[] {
        while (x.load(acq) == 0) {
        }
        for (int i = 0; i < 100; ++i)
          if (y.load(acq) != 0) return;
        assert(false);
      },
      [] {
        x.store(1, rel);
        y.store(1, rel);
      }}},
    {"looks often at a lock that is held",
     "",
     {[] {
        for (int i = 0; i < 3000; ++i) {
          if (!m.try_lock()) continue;
          m.unlock();
          break;
        }
      },
      [] {
        const std::lock_guard l(m);
        y.store(1, rlx);
      }}},
    {"walks a thousand cells",
     "",
     {[] {
        for (int i = 0; i < 1000; ++i) cells[i].store(1, rlx);
        x.store(1, rel);
      },
      [] {
        int sum = 0;
        for (int i = 1000; i < 2000; ++i) sum += cells[i].load(rlx);
        if (x.load(acq) == 1) y.store(sum, rlx);
      }}},
    {"two that look in turn for each other",
     "",
     {[] {
        for (int i = 0; i < 300 && y.load(acq) == 0; ++i) {
        }
        x.store(1, rel);
      },
      [] {
        for (int i = 0;; ++i) {
          if (x.load(acq) == 1) break;
          data2 = i;
        }
        y.store(1, rel);
      }}},
    {"walks in a circle",
     "livelock",
     {[] {
        Node* volatile at = &circle;
        while (at != nullptr) at = at->next;
      },
      no_work},
     [] { circle.next = &circle; }},
    {"waits for ever at the end",
     "livelock",
     {no_work, no_work},
     no_work,
     [] {
       for (int i = 0; x.load(acq) == 0; ++i) data = i & 7;
     }},
    {"waits politely",
     "",
     {[] {
        while (x.load(acq) == 0) std::this_thread::yield();
      },
      [] { x.store(1, rel); }}},
    {"waits with a counter",
     "",
     {[] {
        for (int i = 0; x.load(acq) == 0; ++i) {
          if (i == 3) std::this_thread::yield();
        }
      },
      [] { x.store(1, rel); }}},
    {"spin lock",
     "",
     {[] {
        while (x.exchange(1, acq) != 0) {
        }
        ++data;
        x.store(0, rel);
      },
      [] {
        while (x.exchange(1, acq) != 0) {
        }
        ++data;
        x.store(0, rel);
      }}},
    {"spin lock by flag",
     "",
     {[] {
        while (flag.test_and_set(acq)) {
        }
        ++data;
        flag.clear(rel);
      },
      [] {
        while (flag.test_and_set(acq)) {
        }
        ++data;
        flag.clear(rel);
      }}},
    {"spin lock released without release",
     "data race",
     {[] {
        while (x.exchange(1, acq) != 0) {
        }
        ++data;
        x.store(0, rlx);
      },
      [] {
        while (x.exchange(1, acq) != 0) {
        }
        ++data;
        x.store(0, rlx);
      }}},
    {"spin by compare_exchange",
     "",
     {[] {
        int e = 0;
        while (!x.compare_exchange_weak(e, 1, acq, rlx)) e = 0;
        ++data;
        x.store(0, rel);
      },
      [] {
        int e = 0;
        while (!x.compare_exchange_weak(e, 1, acq, rlx)) e = 0;
        ++data;
        x.store(0, rel);
      }}},
    {"condition",
     "",
     {wait_until_ready,
      [] {
        {
          const std::lock_guard l(m);
          ready = true;
        }
        condition.notify_one();
      }}},
    {"notified before it waits",
     "deadlock",
     {[] {
        std::unique_lock l(m);
        condition.wait(l);
      },
      [] {
        const std::lock_guard l(m);
        condition.notify_one();
      }}},
    {"one notification for two",
     "deadlock",
     {wait_until_ready, wait_until_ready,
      [] {
        const std::lock_guard l(m);
        ready = true;
        condition.notify_one();
      }}},
    {"all are notified",
     "",
     {wait_until_ready, wait_until_ready,
      [] {
        const std::lock_guard l(m);
        ready = true;
        condition.notify_all();
      }}},
    {"waits with a time-out",
     "",
     {[] {
        std::unique_lock l(m);
        condition.wait_for(l, std::chrono::seconds(1));
      },
      no_work}},
    {"atomic wait",
     "",
     {[] { x.wait(0); },
      [] {
        x.store(1);
        x.notify_one();
      }}},
    // libstdc++ 12 looks for waiters with a seq_cst load, which a weaker store may pass, so that
    // the notification would be skipped: no fault of the code's (virtual_cores/library/headers).
    {"atomic wait, notified after a release",
     "",
     {[] { x.wait(0); },
      [] {
        x.store(1, rel);
        x.notify_one();
      }}},
    {"atomic wait without a notification",
     "deadlock",
     {[] { x.wait(0); }, [] { x.store(1, rel); }}},
    {"semaphore",
     "",
     {[] {
        sem_wait(&semaphore);
        x.store(data, rlx);
      },
      [] {
        data = 1;
        sem_post(&semaphore);
      }},
     [] { sem_init(&semaphore, 0, 0); }},
    {"semaphore without a post",
     "deadlock",
     {[] {
        sem_wait(&semaphore);
        sem_wait(&semaphore);
      },
      [] { sem_post(&semaphore); }},
     [] { sem_init(&semaphore, 0, 0); }},
    {"barrier",
     "",
     {[] {
        data = 1;
        pthread_barrier_wait(&barrier);
      },
      [] {
        pthread_barrier_wait(&barrier);
        x.store(data, rlx);
      }},
     [] { pthread_barrier_init(&barrier, nullptr, 2); }},
    {"readers and a writer",
     "",
     {[] {
        pthread_rwlock_rdlock(&rw_lock);
        x.store(data, rlx);
        pthread_rwlock_unlock(&rw_lock);
      },
      [] {
        pthread_rwlock_wrlock(&rw_lock);
        data = 1;
        pthread_rwlock_unlock(&rw_lock);
      }}},
    {"a writer among readers",
     "data race",
     {[] {
        pthread_rwlock_rdlock(&rw_lock);
        x.store(data, rlx);
        pthread_rwlock_unlock(&rw_lock);
      },
      [] {
        pthread_rwlock_rdlock(&rw_lock);
        data = 1;
        pthread_rwlock_unlock(&rw_lock);
      }}},
    {"lazily made",
     "",
     {[] {
        static const int once = data + 1;
        x.store(once, rlx);
      },
      [] {
        static const int twice = data + 2;
        x.store(twice, rlx);
      }}},
};

}  // namespace

std::span<const Program> waiting_programs() {
  return programs;
}

}  // namespace irt::findings
