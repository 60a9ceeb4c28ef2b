// Small programs with one fault each, and healthy twins, compiled for virtual cores.

#include <atomic>
#include <cassert>
#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <pthread.h>
#include <semaphore.h>
#include <stdexcept>
#include <thread>

#include "tests/stress/checker/findings.hpp"

namespace {

using std::atomic;
constexpr auto rlx = std::memory_order_relaxed;
constexpr auto acq = std::memory_order_acquire;
constexpr auto rel = std::memory_order_release;

atomic<int> x, y;
atomic<int*> shared;
int data;
int* block;
std::mutex m, n;
std::condition_variable condition;
bool ready;
sem_t semaphore;
pthread_barrier_t barrier;
pthread_rwlock_t rw_lock;
std::atomic_flag flag;

void no_work() {}

const irt::findings::Program programs[] = {
    // --- Memory
    {"race", "data race", {[] { data = 1; }, [] { data = 2; }}},
    {"race read", "data race", {[] { data = 1; }, [] { x.store(data, rlx); }}},
    {"race of atomic and plain",
     "data race",
     {[] { x.store(1, rlx); }, [] { *reinterpret_cast<volatile int*>(&x) = 2; }}},
    {"message passed",
     "",
     {[] {
        data = 1;
        x.store(1, rel);
      },
      [] {
        if (x.load(acq) == 1) data = 2;
      }}},
    {"use after free",
     "use after free",
     {[] { delete block; }, [] { x.store(*block, rlx); }},
     [] { block = new int(3); }},
    {"free while used",
     "use after free",
     {[] {
        if (y.load(acq) == 1) delete block;
      },
      [] {
        y.store(1, rel);
        *block = 4;
      }},
     [] { block = new int(3); }},
    {"free after use",
     "",
     {[] {
        while (y.load(acq) != 1) {
        }
        delete block;
      },
      [] {
        *block = 4;
        y.store(1, rel);
      }},
     [] { block = new int(3); }},
    {"double free",
     "invalid free",
     {[] { std::free(block); },
      [] {
        if (x.exchange(1, std::memory_order_acq_rel) == 0) no_work();
      }},
     [] { block = static_cast<int*>(std::malloc(4)); },
     [] { std::free(block); }},
    {"free in the middle",
     "invalid free",
     {[] {
        int* volatile middle = block + 1;
        std::free(middle);
      },
      no_work},
     [] { block = static_cast<int*>(std::malloc(8)); }},
    {"leak", "memory leak", {[] { block = new int(1); }, no_work}, no_work, no_work},
    {"no leak", "", {[] { block = new int(1); }, no_work}, no_work, [] { delete block; }},
    {"past the end",
     "access out of bounds",
     {[] { static_cast<volatile int*>(block)[2] = 1; }, no_work},
     [] { block = new int[2]{}; }},
    {"before the beginning",
     "access out of bounds",
     {[] { static_cast<volatile int*>(block)[-1] = 1; }, no_work},
     [] { block = new int[2]{}; }},
    {"uninitialised",
     "read of uninitialised memory",
     {[] { x.store(*block, rlx); }, no_work},
     [] { block = new int; }},
    {"publish without release",
     "data race",
     {[] { shared.store(new int(5), rlx); },
      [] {
        if (int* p = shared.load(acq)) x.store(*p, rlx);
      }}},
    {"publish with release",
     "",
     {[] { shared.store(new int(5), rel); },
      [] {
        if (int* p = shared.load(acq)) x.store(*p, rlx);
      }}},

    // --- Waiting
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
     {[] {
        std::unique_lock l(m);
        condition.wait(l, [] { return ready; });
      },
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
     {[] {
        std::unique_lock l(m);
        condition.wait(l, [] { return ready; });
      },
      [] {
        std::unique_lock l(m);
        condition.wait(l, [] { return ready; });
      },
      [] {
        const std::lock_guard l(m);
        ready = true;
        condition.notify_one();
      }}},
    {"all are notified",
     "",
     {[] {
        std::unique_lock l(m);
        condition.wait(l, [] { return ready; });
      },
      [] {
        std::unique_lock l(m);
        condition.wait(l, [] { return ready; });
      },
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
    // libstdc++ 12 looks for waiters with a seq_cst load, which a weaker store may pass: the
    // notification is skipped while the waiter still sees the old value.
    {"atomic wait, notified after a release",
     "deadlock",
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

    // --- The code's own words
    {"assertion", "failure", {[] { x.store(1, rlx); }, [] { assert(x.load(rlx) == 0); }}},
    {"exception",
     "failure",
     {[] {
        if (x.load(rlx) == 1) throw std::runtime_error("seen");
      },
      [] { x.store(1, rlx); }}},
    {"exception caught",
     "",
     {[] {
        try {
          if (x.load(rlx) == 1) throw std::runtime_error("seen");
        } catch (...) {
          y.store(1, rlx);
        }
      },
      [] { x.store(1, rlx); }}},
    {"abort",
     "failure",
     {[] {
        if (x.load(rlx) == 1) std::abort();
      },
      [] { x.store(1, rlx); }}},
    {"Dekker without seq_cst",
     "data race",
     {[] {
        x.store(1, rel);
        if (y.load(acq) == 0) data = 1;
      },
      [] {
        y.store(1, rel);
        if (x.load(acq) == 0) data = 2;
      }}},
    {"Dekker",
     "",
     {[] {
        x.store(1);
        if (y.load() == 0) data = 1;
      },
      [] {
        y.store(1);
        if (x.load() == 0) data = 2;
      }}},
    {"wild pointer",
     "failure",
     {[] {
        // No memory is mapped that low.
        const auto low = static_cast<std::uintptr_t>(data) + 64;
        // NOLINTNEXTLINE(performance-no-int-to-ptr): that is the fault
        if (x.load(rlx) == 1) *reinterpret_cast<volatile int*>(low) = 1;
      },
      [] { x.store(1, rlx); }}},
    {"lock tried until ready",
     "",
     {[] {
        std::unique_lock lock(m);
        while (!ready) {
          lock.unlock();
          lock.lock();
        }
      },
      [] {
        const std::lock_guard lock(m);
        ready = true;
      }}},
    {"mixed sizes",
     "",
     {[] {
        __atomic_store_n(reinterpret_cast<char*>(&x), 1, __ATOMIC_RELEASE);
        data = 0;
      },
      [] { y.store(x.load(acq) & 1, rlx); }}},
    {"memory comes back",
     "",
     {[] {
        void* const first = std::malloc(8);
        const auto place = reinterpret_cast<std::uintptr_t>(first);
        std::free(first);
        void* const second = std::malloc(8);
        assert(place != reinterpret_cast<std::uintptr_t>(second));
        std::free(second);
      },
      no_work}},
    {"memory runs out",
     "",
     {[] {
        void* const first = std::malloc(8);
        void* const second = std::malloc(8);
        assert(first != nullptr || second != nullptr);
        std::free(second);
        std::free(first);
      },
      no_work}},
};

}  // namespace

/// What no hook announces.
extern "C" void irt_findings_assembly(int* counter) {
  asm volatile("lock addl $1, %0" : "+m"(*counter));
}

extern "C" const irt::findings::Program* irt_findings_programs(unsigned* count) {
  *count = sizeof programs / sizeof *programs;
  return programs;
}
