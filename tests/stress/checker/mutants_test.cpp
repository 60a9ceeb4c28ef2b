// Every mutant is found, and its healthy twin passes the same shapes.

#include "stress/mutants/mutants.hpp"

#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "stress/checker/queue_client.hpp"

namespace {

namespace checker = irt::checker;

struct Plan {
  std::vector<std::string> shapes;  ///< empty: the battery
  std::size_t capacity = 1;
};

/// Queues that need more than the battery: a pop that parks, a page to fill, an index to wrap.
const std::map<std::string_view, Plan>& plans() {
  static const std::map<std::string_view, Plan> table{
      {"m20", {{"E|E|D|D;C"}}},
      {"m21", {{"EE|D|D;C"}}},
      {"m23", {{"E|D;C"}}},
      {"m25", {{"C|D"}}},
  };
  return table;
}

class Mutants : public testing::Test {
 protected:
  Mutants() {
    std::size_t count = 0;
    const auto* first =
        module_.function<const irt::stress::Mutant*(std::size_t*)>("irt_mutants")(&count);
    mutants_.assign(first, first + count);  // the module's own go when its globals are reset
  }

  std::string first_finding(const irt::QueueEntry& entry, std::string_view id,
                            const checker::Options& options) {
    const auto planned = plans().find(id);
    const Plan plan = planned == plans().end() ? Plan{} : planned->second;
    const std::vector<std::string> shapes =
        plan.shapes.empty() ? checker::battery(entry.claims) : plan.shapes;
    for (const std::string& shape : shapes) {
      checker::QueueClient client(entry, checker::parse_shape(shape), plan.capacity, &module_);
      const checker::Result result = check(client.scenario(), options);
      if (result.finding)
        return std::string(name_of(result.finding->kind)) + " on " + shape + ": " +
               result.finding->text;
    }
    return "";
  }

  irt::virtual_cores::Module module_{IRT_MUTANTS_PROBE};
  std::vector<irt::stress::Mutant> mutants_;
};

}  // namespace

TEST_F(Mutants, matrix) {
  for (const irt::stress::Mutant& mutant : mutants_) {
    const auto t = std::chrono::steady_clock::now();
    const std::string bug = first_finding(mutant.queue, mutant.id, {.seconds = 1});
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
    const std::string twin = first_finding(mutant.twin, mutant.id, {.seconds = 0.3});
    std::printf("%-10s %.2fs %s\n      TWIN %s\n", std::string(mutant.id).c_str(), s, bug.c_str(),
                twin.c_str());
    std::fflush(stdout);
  }
}
