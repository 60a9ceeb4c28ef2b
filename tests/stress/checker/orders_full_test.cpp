// Orders of the tree's queues that only large programs show to be needed.

#include <gtest/gtest.h>
#include <map>

#include "stress/checker/queue_client.hpp"
#include "stress/virtual_cores/queue_modules.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::checker {
namespace {

// With an acquire load there, a pop by the clock may answer empty beside an element.
TEST(Orders, lcrq_goes_on_in_the_next_ring_behind_what_linked_it) {
  virtual_cores::Module module(virtual_cores::QueueModules().at("lcrq"));
  QueueClient client(virtual_cores::queue_of(module), parse_shape("EEE|EEE|DDD|DDD@1"), 0, &module,
                     true);
  Options options;
  options.search = Search::pos;
  options.seconds = 1;
  options.watch_orders = true;
  const Result seen = check(client.program(), options);
  ASSERT_FALSE(seen.finding) << seen.finding->text;

  // Push and pop look for the next ring by the same line; push comes first.
  symbols::Symbols symbols(module);
  std::map<unsigned, std::vector<OrderSite>> looks;
  for (const OrderSite& site : seen.order_sites) {
    const symbols::Line& line = symbols.at(site.pc);
    if (site.kind == EventKind::load && line.text.find("ring->next.load") != std::string::npos)
      looks[line.number].push_back(site);
  }
  ASSERT_EQ(looks.size(), 2U);
  for (const OrderSite& site : looks.begin()->second) {
    ASSERT_EQ(site.order, virtual_cores::Order::seq_cst);
    options.weakened.emplace_back(site, virtual_cores::Order::acquire);
  }
  options.watch_orders = false;
  options.seconds = 300;
  options.executions = 1'000'000;
  const Result weaker = check(client.program(), options);
  ASSERT_TRUE(weaker.finding) << "nothing in " << weaker.executions << " executions";
  EXPECT_EQ(weaker.finding->kind, FindingKind::wrong_outcome);
}

}  // namespace
}  // namespace irt::checker
