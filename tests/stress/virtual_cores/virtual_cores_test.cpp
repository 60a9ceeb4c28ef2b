#include "stress/virtual_cores/virtual_cores.hpp"

#include <atomic>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace vc = irt::virtual_cores;

namespace {

struct Failure {
  std::string what;
};

/// Counts events, switches to the next unfinished core at each access to an atomic, and lets
/// waiting cores spin.
class Rotating : public vc::Tenant {
 public:
  explicit Rotating(unsigned count) : cores(*this, count) {}

  void run(const std::vector<std::function<void()>>& work) {
    work_ = work;
    done_.assign(work.size(), false);
    for (unsigned core = 0; core < work.size(); ++core)
      cores.arm(
          core, [](void* w) { (*static_cast<std::function<void()>*>(w))(); }, &work_[core]);
    cores.run(0);
  }

  void plain_read(std::uintptr_t address, std::size_t size, const void*) override {
    reads[address] = size;
  }
  void plain_write(std::uintptr_t address, std::size_t size, const void*) override {
    writes[address] = size;
  }
  vc::Value load(const vc::Access& access) override {
    rotate();
    return Tenant::load(access);
  }
  void store(const vc::Access& access, vc::Value value) override {
    rotate();
    Tenant::store(access, value);
  }
  vc::Value modify(const vc::Access& access, vc::Modification operation,
                   vc::Value operand) override {
    rotate();
    ++modifications;
    return Tenant::modify(access, operation, operand);
  }
  bool compare_exchange(const vc::Access& access, vc::Order failure, bool weak, vc::Value& expected,
                        vc::Value desired) override {
    rotate();
    return Tenant::compare_exchange(access, failure, weak, expected, desired);
  }
  void fence(vc::Order order, const void*) override { fences.push_back(order); }
  vc::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t,
                const void*) override {
    ++waits;
    while (vc::read_memory(address, 4) == expected) rotate();
    return vc::Wake::woken;
  }
  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override {
    ++allocations;
    return Tenant::allocate(size, alignment, pc);
  }
  void release(void* block, const void* pc) override {
    ++releases;
    Tenant::release(block, pc);
  }
  unsigned finished(unsigned core) override {
    done_[core] = true;
    return next();
  }
  void on_failure(const std::string& what, const void*) override {
    what_failed = what;
    cores.switch_to(vc::host);
  }

  void rotate() {
    const unsigned to = next();
    if (to != vc::host) cores.switch_to(to);
  }

  vc::Cores cores;
  std::map<std::uintptr_t, std::size_t> reads, writes;
  std::vector<vc::Order> fences;
  std::string what_failed;
  unsigned modifications = 0, waits = 0, allocations = 0, releases = 0;

 private:
  [[nodiscard]] unsigned next() const {
    for (unsigned i = 1; i <= done_.size(); ++i) {
      const unsigned core = (cores.current() + i) % static_cast<unsigned>(done_.size());
      if (!done_[core]) return core;
    }
    return vc::host;
  }

  std::vector<std::function<void()>> work_;
  std::vector<bool> done_;
};

class VirtualCores : public testing::Test {
 protected:
  void SetUp() override { module.reset_globals(); }

  template <class F>
  F* function(const char* name) {
    return module.function<F>(name);
  }
  vc::Module module{IRT_PROBE};
};

}  // namespace

TEST_F(VirtualCores, every_width_and_operation_computes_what_it_should) {
  Rotating tenant(2);
  bool narrow = false;
  bool wide = false;
  tenant.run({[&] { narrow = function<bool()>("irt_atomics")(); },
              [&] { wide = function<bool()>("irt_pair")(); }});
  EXPECT_TRUE(narrow);
  EXPECT_TRUE(wide);
}

TEST_F(VirtualCores, plain_accesses_copies_and_fences_are_announced) {
  Rotating tenant(1);
  std::uint32_t words[2] = {3, 0};
  char from[100] = "text";
  char to[100] = "";
  tenant.run({[&] {
    function<void(std::uint32_t*, char*, const char*, std::size_t)>("irt_plain")(words, to, from,
                                                                                 100);
  }});
  const auto address = [](const void* p) { return reinterpret_cast<std::uintptr_t>(p); };
  EXPECT_EQ(words[1], 3U);
  EXPECT_STREQ(to, "text");
  EXPECT_EQ(tenant.reads[address(&words[0])], 4U);
  EXPECT_EQ(tenant.writes[address(&words[1])], 4U);
  EXPECT_EQ(tenant.reads[address(from)], 100U);
  EXPECT_EQ(tenant.writes[address(to)], 100U);
  EXPECT_EQ(tenant.fences, std::vector{vc::Order::release});
}

TEST_F(VirtualCores, thread_locals_belong_to_a_core_and_start_afresh) {
  Rotating tenant(2);
  for (int round = 0; round < 2; ++round) {
    int* first = nullptr;
    int* second = nullptr;
    int value = 0;
    tenant.run({[&] {
                  function<void(int**)>("irt_count_own")(&first);
                  function<void(int**)>("irt_count_own")(&first);
                  value = function<int()>("irt_own_counter")();
                },
                [&] { function<void(int**)>("irt_count_own")(&second); }});
    EXPECT_NE(first, second);
    EXPECT_EQ(value, 42 * 100 + 5);
    EXPECT_EQ(*second, 41) << "readable from outside through its published address";
  }
}

TEST_F(VirtualCores, destructors_of_thread_locals_run_when_a_core_ends) {
  Rotating tenant(2);
  std::atomic<int> ended{0};
  const auto work = [&] { function<void(std::atomic<int>*)>("irt_at_exit")(&ended); };
  tenant.run({work, work});
  EXPECT_EQ(ended.load(), 2);
}

TEST_F(VirtualCores, condition_variables_and_atomic_wait_block_only_their_core) {
  Rotating tenant(2);
  tenant.run({function<void()>("irt_wait_for_flag"), function<void()>("irt_raise_flag")});
  EXPECT_GE(tenant.waits, 1U);
  module.reset_globals();
  tenant.run({function<void()>("irt_atomic_wait"), function<void()>("irt_atomic_notify")});
  EXPECT_TRUE(tenant.what_failed.empty()) << tenant.what_failed;
}

TEST_F(VirtualCores, globals_and_statics_start_afresh) {
  Rotating tenant(1);
  for (int round = 0; round < 2; ++round) {
    int counted = 0;
    int made = 0;
    module.reset_globals();
    tenant.run({[&] {
      counted = function<int()>("irt_count_global")();
      made = function<int()>("irt_static")();
    }});
    EXPECT_EQ(counted, 8);
    EXPECT_EQ(made, 5);
  }
  EXPECT_EQ(tenant.allocations, 2U);
}

TEST_F(VirtualCores, exceptions_stay_on_their_core) {
  Rotating tenant(2);
  bool first = false;
  bool second = false;
  tenant.run({[&] { first = function<bool()>("irt_throw_and_catch")(); },
              [&] {
                second = std::uncaught_exceptions() == 0;
                function<void()>("irt_atomic_notify")();
              }});
  EXPECT_TRUE(first);
  EXPECT_TRUE(second);
  tenant.run({function<void()>("irt_throw")});
  EXPECT_NE(tenant.what_failed.find("thrown by the probe"), std::string::npos)
      << tenant.what_failed;
}

TEST_F(VirtualCores, shared_pointers_count_atomically) {
  Rotating tenant(1);
  tenant.run({[&] { function<void(void*)>("irt_unshare")(function<void*()>("irt_share")()); }});
  EXPECT_GT(tenant.modifications, 0U);
  EXPECT_EQ(tenant.allocations, 2U);
  EXPECT_EQ(tenant.releases, 2U);
}

TEST_F(VirtualCores, a_module_names_the_calls_nobody_sees) {
  EXPECT_EQ(module.unseen_calls(), (std::vector<std::string>{"qsort", "std::get_terminate()"}))
      << testing::PrintToString(module.unseen_calls());
  EXPECT_THROW(std::ignore = module.find("irt_no_such_function"), std::runtime_error);
  EXPECT_THROW(vc::Module("no_such_file.so"), std::runtime_error);
}

// By a fault in the runtime, on behalf of the code, and in the runtime's own right.
TEST_F(VirtualCores, a_fault_is_the_codes_where_the_code_asked_for_the_memory) {
  Rotating tenant(1);
  tenant.run({[&] { function<void(std::uintptr_t, int)>("irt_hammer")(64, 1); }});
  EXPECT_NE(tenant.what_failed.find("memory that is not there (0x40)"), std::string::npos)
      << tenant.what_failed;
}

TEST_F(VirtualCores, a_crash_of_the_tenant_is_nobodys_fault) {
  class Crashing final : public Rotating {
   public:
    using Rotating::Rotating;
    vc::Value modify(const vc::Access&, vc::Modification, vc::Value) override {
      return vc::read_memory(4096 + 64, 8);
    }
  };
  std::atomic<std::uint64_t> counter{0};
  const auto crash = [&] {
    Crashing tenant(1);
    tenant.run({[&] { function<void(void*, std::uint64_t)>("irt_hammer")(&counter, 1); }});
  };
  EXPECT_EXIT(crash(), testing::ExitedWithCode(3), "outside of the code that is looked at");
}

TEST_F(VirtualCores, chance_and_clocks_are_the_tenants) {
  class Seeded final : public Rotating {
   public:
    using Rotating::Rotating;
    std::uint64_t random() override { return 0x1234'5678'0000'0000U + ++draws; }
    std::int64_t now() override { return 0x7'0000'0000 + ++reads_of_clock; }
    unsigned draws = 0, reads_of_clock = 0;
  };
  Seeded tenant(1);
  std::uint64_t answers[8] = {};
  tenant.run({[&] { function<void(std::uint64_t*)>("irt_chance")(answers); }});
  EXPECT_EQ(tenant.what_failed, "");
  EXPECT_EQ(answers[0], 0x1234'5678U) << "std::random_device";
  EXPECT_EQ(answers[1], 0x1234'5678'0000'0002U) << "getrandom";
  EXPECT_EQ(answers[2], 0x7'0000'0001U) << "rdtsc";
  EXPECT_EQ(answers[3], 0x7'0000'0002U) << "steady_clock";
  EXPECT_EQ(answers[4], 0x1234'5678'0000'0003U) << "rdrand";
  EXPECT_EQ(answers[5], 0x4U) << "rdrand, 32 bits";
}

TEST_F(VirtualCores, a_thread_of_the_codes_own_is_refused) {
  const auto start = [&] {
    Rotating tenant(1);
    tenant.run({function<void()>("irt_start_thread")});
  };
  EXPECT_EXIT(start(), testing::ExitedWithCode(2), "starts a thread of its own");
}

TEST_F(VirtualCores, switches_between_many_cores_lose_nothing) {
  Rotating tenant(64);
  std::atomic<std::uint64_t> counter{0};
  std::vector<std::function<void()>> work(64, [&] {
    function<void(std::atomic<std::uint64_t>*, std::uint64_t)>("irt_hammer")(&counter, 10'000);
  });
  tenant.run(work);
  EXPECT_EQ(counter.load(), 640'000U);
}
