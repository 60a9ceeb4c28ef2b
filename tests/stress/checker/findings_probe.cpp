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

struct Node {
  Node* next;
};
atomic<Node*> registry;
thread_local Node* volatile mine;
std::uintptr_t marked, shifted;

Node circle;
atomic<int> cells[2000];
int data2;

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
     "double free",
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
    {"leak",
     "memory leak",
     {[] { *static_cast<int* volatile*>(&block) = new int(1); }, no_work},
     no_work,
     [] { block = nullptr; }},
    {"no leak", "", {[] { block = new int(1); }, no_work}, no_work, [] { delete block; }},
    {"kept by a global",
     "",
     {[] {
        auto* list = new Node{nullptr};
        registry.store(new Node{list}, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"kept with marks in the pointer",
     "",
     {[] { marked = reinterpret_cast<std::uintptr_t>(new Node{new Node{nullptr}}) | 1U << 2U; },
      [] { shifted = reinterpret_cast<std::uintptr_t>(new Node{nullptr}) << 16U | 7U; }},
     no_work,
     no_work},
    {"a lost circle",
     "memory leak",
     {[] {
        auto* first = new Node{nullptr};
        registry.store(first, rlx);
        first->next = new Node{first};
        registry.store(nullptr, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"dropped from the registry",
     "memory leak",
     {[] {
        registry.store(new Node{new Node{nullptr}}, rlx);
        registry.store(nullptr, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"kept by a thread that has ended",
     "memory leak",
     {[] { mine = new Node{nullptr}; }, no_work},
     no_work,
     no_work},
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

    // --- Limits: no finding, and no proof
    {"more steps than are looked at",
     "not proved",
     {[] {
        for (int round = 0; round < 30; ++round)
          for (auto& cell : cells) cell.store(round, rlx);
      },
      no_work}},
    {"more memory than there is",
     "not proved",
     {[] {
        for (int i = 0; i < 200; ++i) {
          void* volatile megabyte = std::calloc(1, std::size_t{1} << 20U);
          std::free(megabyte);
        }
      },
      no_work}},

    {"thousands of seq_cst operations",
     "",
     {[] {
        for (int round = 0; round < 3; ++round)
          for (auto& cell : cells) cell.store(round);
        x.store(y.load());
      },
      [] { y.store(x.load()); }}},

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
