// Who stops whom: a lock of the queue's own blocks, a lock of the loader, the allocator or the C++
// runtime is nobody's claim.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "broken_queues.hpp"
#include "machinery.hpp"
#include "running.hpp"
#include "stress/mutants/rings.hpp"
#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

TEST(ProgressSuite, SeesThatALockBlocks) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result honest = run(broken_entry<Defect::none>(), 3, run_progress);
  EXPECT_TRUE(honest.findings.empty());
  const Result boast = run(broken_entry<Defect::none, Progress::lock_free>(), 3, run_progress);
  EXPECT_NE(claim_of(boast).find("goes on when another thread is stopped"), std::string::npos)
      << claim_of(boast);
}

TEST(ProgressSuite, SeesThatAStoppedThreadHidesElements) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result boast = run(queue_entry<Vyukov<VyukovBug::boasts>::Queue>("boast"), 5, run_progress);
  EXPECT_NE(claim_of(boast).find("goes on when another thread is stopped"), std::string::npos)
      << claim_of(boast);
  EXPECT_NE(boast.findings[0].evidence.find("answered"), std::string::npos)
      << boast.findings[0].evidence;
}

TEST(ProgressSuite, LeavesALockFreeQueueAlone) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  const Result result =
      run(queue_entry<Recycled<RecycledBug::none>::Queue>("list"), 2, run_progress);
  EXPECT_EQ(claim_of(result), "nothing") << result.findings[0].evidence;
  EXPECT_GT(result.figures.value("suspensions", 0), 0);
}

/// A queue of machinery_plugin.cpp.
const QueueEntry* through(Machinery machinery) {
  void* object = dlopen(IRT_MACHINERY_PLUGIN, RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw std::runtime_error(dlerror());
  using Find = const QueueEntry* (*)(Machinery);
  return reinterpret_cast<Find>(dlsym(object, "irt_machinery"))(machinery);
}

TEST(ProgressSuite, HoldsNobodyInTheLoaderTheAllocatorOrTheRuntime) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  for (const Machinery machinery : {Machinery::loader, Machinery::exceptions, Machinery::allocator,
                                    Machinery::thread_local_storage}) {
    const QueueEntry* entry = through(machinery);
    Result result = run(*entry, 1.5, run_progress);
    // Nearly all the time is the machinery's: on a busy machine nobody may have been held.
    for (int tries = 0; tries < 5 && result.figures.value("suspensions", 0) < 3; ++tries)
      result = run(*entry, 1.5, run_progress);
    EXPECT_EQ(claim_of(result), "nothing") << entry->name << "\n" << result.findings[0].evidence;
    EXPECT_EQ(result.figures.value("push", ""), "goes on") << entry->name;
    EXPECT_EQ(result.figures.value("pop", ""), "goes on") << entry->name;
  }
}

TEST(ProgressSuite, ALockThatIsHeldInTheCLibraryAloneIsTheQueuesOwn) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "signals are delayed";
  for (const QueueEntry& entry :
       {queue_entry<Sleeps<true>::Queue>("naps"), queue_entry<Sleeps<false>::Queue>("second")}) {
    const Result result = run(entry, 3, run_progress);
    EXPECT_NE(claim_of(result).find("goes on when another thread is stopped"), std::string::npos)
        << entry.name << ": " << claim_of(result);
  }
}

}  // namespace
}  // namespace irt::stress
