// The files that real threads run, on virtual cores: stress/scenarios, judged by stress/history.
// tests/stress/mutants runs the same mutants under the same scenarios on real threads.
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "stress/checker/mutants_check.hpp"
#include "stress/checker/scenario_search.hpp"
#include "stress/running/usage_error.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::checker {
namespace {

CheckSettings quick(double seconds) {
  CheckSettings settings;
  settings.seconds = seconds;
  settings.jobs = 1;
  settings.quiet = true;
  settings.reports = false;
  return settings;
}

class ScenariosOfMutants : public testing::Test {
 protected:
  [[nodiscard]] stress::Mutant mutant(std::string_view id) {
    for (const stress::Mutant& each : mutants_of(module_))
      if (each.id == id) return each;
    throw std::invalid_argument("no such mutant");
  }
  /// The scenario that shows it on real threads.
  static const stress::Scenario& scenario_of(const stress::Mutant& mutant) {
    return scenario_at(std::string(mutant.scenario.name), mutant.queue);
  }
  ShapeResult sample(const QueueEntry& queue, const stress::Scenario& scenario,
                     CheckSettings settings) {
    settings.real_time = false;  // what mutants claim of time is for real threads to judge
    return sample_scenario(queue, module_, scenario, settings, "irt check");
  }

  virtual_cores::Module module_{IRT_MUTANTS_MODULE};
};

TEST_F(ScenariosOfMutants, BugsAreFoundThatRealThreadsFind) {
  for (const char* id : {"m01", "m02", "m13", "m26", "m28", "m30", "m31", "m32", "m47", "m48"}) {
    const stress::Mutant broken = mutant(id);
    EXPECT_TRUE(sample(broken.queue, scenario_of(broken), quick(20)).result.finding) << id;
  }
}

TEST_F(ScenariosOfMutants, BugsAreFoundThatOnlyAMemoryModelShows) {
  for (const char* id : {"m05", "m07", "m11", "m11b", "m37"}) {
    const stress::Mutant broken = mutant(id);
    EXPECT_TRUE(sample(broken.queue, scenario_of(broken), quick(20)).result.finding) << id;
  }
}

TEST_F(ScenariosOfMutants, AContentionScenarioFindsABugAndPassesItsTwin) {
  const stress::Mutant broken = mutant("m02");
  const stress::Scenario& pairs = scenario_at("contention/pairs", broken.queue);
  EXPECT_TRUE(sample(broken.queue, pairs, quick(20)).result.finding);
  EXPECT_FALSE(sample(broken.twin, pairs, quick(0.3)).result.finding);
}

TEST_F(ScenariosOfMutants, TwinsPass) {
  for (const char* id : {"m01", "m02", "m13", "m26", "m28", "m31", "m37", "m47"}) {
    const stress::Mutant broken = mutant(id);
    const ShapeResult twin = sample(broken.twin, scenario_of(broken), quick(0.3));
    EXPECT_FALSE(twin.result.finding) << id << ": " << twin.result.finding->text;
    EXPECT_GT(twin.result.complete, 0U);
  }
}

TEST_F(ScenariosOfMutants, EverySearchFindsOneAlone) {
  const stress::Mutant broken = mutant("m26");
  for (const Search search : {Search::pos, Search::pct, Search::random}) {
    CheckSettings settings = quick(20);
    settings.search = search;
    EXPECT_TRUE(sample(broken.queue, scenario_of(broken), settings).result.finding)
        << static_cast<int>(search);
  }
}

TEST_F(ScenariosOfMutants, AReportComesOutAgain) {
  const stress::Mutant broken = mutant("m13");
  CheckSettings settings = quick(20);
  settings.real_time = false;
  settings.reports = true;
  const ShapeResult found = sample(broken.queue, scenario_of(broken), settings);
  ASSERT_TRUE(found.result.finding);
  const auto at = found.report.rfind("--seed ");
  ASSERT_NE(at, std::string::npos) << found.report;
  settings.options.seed = std::stoull(found.report.substr(at + 7));
  const auto begin = found.report.find('"', at) + 1;
  const std::string schedule = found.report.substr(begin, found.report.rfind('"') - begin);
  const std::string again =
      replay(broken.queue, module_, scenario_of(broken), settings, schedule, "");
  ASSERT_FALSE(again.empty());
  EXPECT_EQ(found.report.find(again.substr(0, again.find('\n'))), 0U) << found.report << again;
}

TEST_F(ScenariosOfMutants, JobsChangeNothing) {
  const stress::Mutant broken = mutant("m13");
  CheckSettings settings = quick(20);
  const Result alone = sample(broken.queue, scenario_of(broken), settings).result;
  settings.jobs = 2;
  const Result both = sample(broken.queue, scenario_of(broken), settings).result;
  ASSERT_TRUE(alone.finding && both.finding);
  EXPECT_EQ(to_string(alone.schedule), to_string(both.schedule));
  EXPECT_EQ(alone.executions, both.executions);
}

class ScenariosOfQueues : public testing::TestWithParam<const char*> {};

TEST_P(ScenariosOfQueues, FindNothing) {
  virtual_cores::Module module(virtual_cores::QueueModules().at(GetParam()));
  const QueueEntry& entry = virtual_cores::queue_of(module);
  std::vector<stress::Scenario> all(stress::scenarios().begin(), stress::scenarios().end());
  all.insert(all.end(), stress::contention_scenarios().begin(),
             stress::contention_scenarios().end());
  for (const stress::Scenario& scenario : all) {
    if (scenario.generations != 1 || !stress::allows(entry.methods, entry.claims, scenario))
      continue;
    ShapeResult result = sample_scenario(entry, module, scenario, quick(0.1), "");
    // Where others have the processors, the first execution may take longer.
    if (result.result.complete == 0)
      result = sample_scenario(entry, module, scenario, quick(5), "");
    EXPECT_FALSE(result.result.finding) << scenario.name << ": " << result.result.finding->text;
    EXPECT_GT(result.result.complete, 0U) << scenario.name;
    EXPECT_EQ(result.result.incomplete, "") << scenario.name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ScenariosOfQueues,
                         testing::Values("lock", "local", "mutex", "vyukov-ring-waiting",
                                         "lfree-waiting"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(ScenarioNames, ThoseThatTheQueueCannotBeUsedInAreRefused) {
  QueueEntry entry;
  EXPECT_EQ(scenario_at("mpmc", entry).name, "mpmc");
  EXPECT_THROW(scenario_at("parked", entry), UsageError);
  EXPECT_THROW(scenario_at("bulk", entry), UsageError);
  EXPECT_THROW(scenario_at("no-such-scenario", entry), UsageError);
  EXPECT_THROW(scenario_at("come-and-go", entry), UsageError);
  entry.methods.pop_wait = true;
  EXPECT_EQ(scenario_at("parked", entry).name, "parked");
  EXPECT_THROW(scenario_at("parked-for-a-while", entry), UsageError);
  entry.claims.max_workers = 1;
  EXPECT_THROW(scenario_at("parked", entry), UsageError);
}

}  // namespace
}  // namespace irt::checker
