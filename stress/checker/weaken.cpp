// Which memory orders does a queue need? Each is weakened in turn, and the battery says what
// breaks.

#include <fmt/format.h>
#include <map>

#include "stress/checker/batteries.hpp"
#include "stress/checker/queue_check.hpp"
#include "stress/checker/report.hpp"
#include "stress/checker/values.hpp"

namespace irt::checker {

namespace {

/// The next weaker orders that the operation may have.
std::vector<Order> weaker(const OrderSite& site) {
  const bool loads = site.kind != EventKind::store;
  const bool stores = site.kind != EventKind::load && !site.failure;
  switch (site.order) {
    case Order::seq_cst:
      if (loads && stores) return {Order::acq_rel};
      return {loads ? Order::acquire : Order::release};
    case Order::acq_rel:
      return {Order::acquire, Order::release};
    case Order::acquire:
    case Order::consume:
    case Order::release:
      return {Order::relaxed};
    case Order::relaxed:
      break;
  }
  return {};
}

}  // namespace

std::size_t mutate_orders(const QueueEntry& entry, virtual_cores::Module& module,
                          const CheckSettings& given) {
  const CheckSettings settings = as_seen(given, module);
  const std::vector<std::string> shapes =
      settings.shapes.empty() ? battery(entry.claims, entry.methods) : settings.shapes;
  // What only the clock's order needs is needed by a queue that claims it.
  const bool clocked =
      settings.real_time.value_or(entry.claims.ordering == Ordering::fifo_real_time);
  Symbols symbols(module);
  // One line of source may have been compiled into several places.
  using Key = std::tuple<std::string, std::string, Order, bool, EventKind>;
  std::map<Key, std::vector<OrderSite>> sites;
  std::map<const void*, bool> known;
  for (const std::string& text : shapes) {
    QueueClient client(entry, parse_shape(text), settings.capacity, &module, clocked);
    Options options = settings.options;
    options.seconds = 1;
    options.watch_orders = true;
    const std::vector<OrderSite> seen = check(client.program(), options).order_sites;
    std::vector<const void*> pcs;
    pcs.reserve(seen.size());
    for (const OrderSite& site : seen) pcs.push_back(site.pc);
    symbols.look_up(pcs);
    for (const OrderSite& site : seen) {
      if (site.pc == nullptr || weaker(site).empty()) continue;
      auto& same = sites[{symbols.name(site.pc), symbols.at(site.pc).text, site.order, site.failure,
                          site.kind}];
      if (!known[site.pc] || site.failure) same.push_back(site);
      known[site.pc] = true;
    }
  }
  std::size_t unneeded = 0;
  for (const auto& [key, places] : sites) {
    if (places.empty()) continue;
    for (const Order order : weaker(places.front())) {
      std::string breaks;
      bool complete = true;
      for (const std::string& text : shapes) {
        QueueClient client(entry, parse_shape(text), settings.capacity, &module, clocked);
        Options options = settings.options;
        options.seconds = settings.seconds / static_cast<double>(shapes.size());
        for (const OrderSite& site : places) options.weakened.emplace_back(site, order);
        const Result result = check(client.program(), options);
        complete = complete && (result.finished || result.finding);
        if (!result.finding) continue;
        breaks = fmt::format("{} on {}", checker::name_of(result.finding->kind), text);
        break;
      }
      if (breaks.empty()) {
        ++unneeded;
        breaks = complete ? "nothing: this battery is proved without it"
                          : "nothing found, but the battery was not finished in time";
      }
      fmt::print("  {:<28} {:<7} -> {:<7} {} | {}\n", std::get<0>(key),
                 name_of(places.front().order), name_of(order), breaks,
                 std::get<1>(key).substr(0, 60));
      std::fflush(stdout);
    }
  }
  return unneeded;
}

}  // namespace irt::checker
