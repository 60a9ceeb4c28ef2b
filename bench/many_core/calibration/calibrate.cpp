#include "bench/many_core/calibration/calibrate.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <stdexcept>
#include <tuple>

#include "bench/conditions/hwloc.hpp"
#include "bench/conditions/system.hpp"

namespace irt::many_core {
namespace {

// The number of the group of `type` that `unit` is in; 0 where there are none.
unsigned group_of(hwloc_topology_t topology, hwloc_obj_type_t type, hwloc_obj_t unit) {
  for (hwloc_obj_t object = nullptr;
       (object = hwloc_get_next_obj_by_type(topology, type, object)) != nullptr;) {
    if (hwloc_bitmap_isset(object->cpuset, unit->os_index) != 0) return object->logical_index;
  }
  return 0;
}

// The cache that cores share: the last level that more than one core is around, or the core's own.
unsigned cache_of(hwloc_topology_t topology, hwloc_obj_t unit) {
  for (const hwloc_obj_type_t type : {HWLOC_OBJ_L3CACHE, HWLOC_OBJ_L2CACHE}) {
    if (hwloc_get_nbobjs_by_type(topology, type) > 0) return group_of(topology, type, unit);
  }
  return group_of(topology, HWLOC_OBJ_PACKAGE, unit);
}

template <class Key>
unsigned count(const std::vector<Place>& places, Key key) {
  std::set<decltype(key(places[0]))> seen;
  for (const Place& place : places) seen.insert(key(place));
  return static_cast<unsigned>(seen.size());
}

Origin measured(const Spread& spread, const std::string& date, const std::string& how) {
  std::string source = "measured, " + date;
  if (!how.empty()) source += ": " + how;
  return {source, spread.low, spread.high};
}

// Writes measured figures into a profile.
class Author {
 public:
  Author(Profile& profile, std::string date) : profile_(profile), date_(std::move(date)) {}

  void write(std::string_view key, const Spread& spread, const std::string& how = "") {
    put(key, spread.median, measured(spread, date_, how));
  }
  void assume(std::string_view key, double value, const std::string& why) {
    put(key, value, {"assumed: " + why, value, value});
  }
  void assume(std::string_view key, double value, double low, double high, const std::string& why) {
    put(key, value, {"assumed: " + why, low, high});
  }

 private:
  void put(std::string_view key, double value, Origin origin) {
    const auto figure = std::ranges::find(figures(), key, &FigureEntry::key);
    figure->of(profile_) = value;
    profile_.origins.insert_or_assign(std::string(key), std::move(origin));
  }

  Profile& profile_;
  std::string date_;
};

void write_alone(Author& author, const Alone& alone) {
  const Spread& cycle = alone.cycle;
  author.write("clock_ghz", {1 / cycle.median, 1 / cycle.high, 1 / cycle.low, 0, 0},
               "one operation per cycle");
  author.write("load_hit", alone.load);
  author.write("store_hit", alone.store);
  author.write("rmw_hit", alone.rmw);
  author.write("plain_op", alone.plain);
  author.write("pause", alone.pause);
  if (alone.dram.bursts != 0) {
    author.write("dram", alone.dram, "loads of flushed lines, one after the other");
  } else {
    author.assume("dram", 100, "no instruction to flush a line is known here");
  }
  author.write("kernel.syscall", alone.syscall, "getppid");
  author.write("kernel.switch_same_core", alone.hand_over,
               "one way between two threads of a core, waking and going to sleep included");
}

// Pairs at `distance`, a few of all.
std::vector<std::pair<Cpu, Cpu>> pairs_at(const Profile& profile, const std::vector<Place>& places,
                                          Distance distance) {
  std::vector<std::pair<Cpu, Cpu>> all;
  for (unsigned a = 0; a < places.size(); ++a) {
    for (unsigned b = a + 1; b < places.size(); ++b) {
      if (profile.distance(a, b) == distance) all.emplace_back(places[a].cpu, places[b].cpu);
    }
  }
  constexpr std::size_t at_most = 6;
  if (all.size() <= at_most) return all;
  std::vector<std::pair<Cpu, Cpu>> some;
  for (std::size_t i = 0; i < at_most; ++i) some.push_back(all[i * all.size() / at_most]);
  return some;
}

// The median pair, with the whole spread.
Spread merge(const std::vector<Spread>& spreads) {
  std::vector<double> medians;
  Spread all;
  for (const Spread& spread : spreads) {
    medians.push_back(spread.median);
    all.low = all.bursts == 0 ? spread.low : std::min(all.low, spread.low);
    all.high = std::max(all.high, spread.high);
    all.bursts += spread.bursts;
    all.dropped += spread.dropped;
  }
  std::erase(medians, 0.0);
  if (medians.empty()) {
    throw std::runtime_error(
        "two cores never ran at the same time for long enough to be measured; try again when the "
        "machine is quieter");
  }
  all.median = summarise(std::move(medians)).median;
  return all;
}

struct Distances {
  Spread nearest_line, nearest_add;  // ping-pong and fetch-and-add between the nearest two cores
};

Distances write_transfers(Author& author, const Profile& profile, const std::vector<Place>& places,
                          Calibration& calibration) {
  Distances found;
  for (std::size_t i = 1; i < distances; ++i) {
    const auto distance = static_cast<Distance>(i);
    if (!profile.has(distance)) continue;
    std::vector<Spread> lines, loads, adds, swaps;
    for (const auto& [a, b] : pairs_at(profile, places, distance)) {
      const Between between = measure_between(a, b);
      lines.push_back(between.ping_pong);
      loads.push_back(between.load);
      adds.push_back(between.fetch_add);
      swaps.push_back(between.swap);
    }
    author.write(
        "transfer." + std::string(name_of(distance)), merge(lines),
        fmt::format("half a round of compare-and-swaps over 24 lines, {} pairs", lines.size()));
    calibration.checks.push_back(fmt::format(
        "{}: of lines the other wrote, one after the other: load {:.1f} ns, fetch-and-add {:.1f}, "
        "compare-and-swap {:.1f}; ping-pong {:.1f}",
        name_of(distance), merge(loads).median, merge(adds).median, merge(swaps).median,
        merge(lines).median));
    if (found.nearest_line.bursts == 0 && distance != Distance::smt_sibling) {
      found = {merge(lines), merge(adds)};
    }
  }
  return found;
}

// The cores around the first cache, a thread each.
std::vector<Cpu> neighbours(const Profile& profile, const std::vector<Place>& places) {
  std::vector<Cpu> cpus;
  for (unsigned i = 0; i < profile.cores_per_cache; ++i) cpus.push_back(places[i].cpu);
  return cpus;
}

void write_conflict(Author& author, const Profile& profile, const std::vector<Place>& places,
                    const Distances& found, Calibration& calibration) {
  constexpr double work_ns = 70;
  const std::vector<Cpu> cpus = neighbours(profile, places);
  const double rmw = profile.rmw_hit;
  if (cpus.size() < 2) {
    author.assume("conflict", 20, 0, 35, "no two cores share a cache here");
    return;
  }
  const Spread period = measure_contended(cpus, work_ns);
  calibration.checks.push_back(
      fmt::format("fetch-and-add of {} cores on one line, {:.0f} ns between: one each {:.1f} ns",
                  cpus.size(), work_ns, period.median));
  if (cpus.size() >= 4) {
    // Four and more keep the line busy all the time.
    const double alone = (1 - profile.overlap) * found.nearest_line.median + rmw;
    author.write("conflict",
                 {std::max(period.median - alone, 0.0), std::max(period.low - alone, 0.0),
                  std::max(period.high - alone, 0.0), period.bursts, period.dropped},
                 "period of contended fetch-and-adds less transfer and hit");
    return;
  }
  const double alone = found.nearest_line.median + rmw;
  const Spread& add = found.nearest_add;
  author.write("conflict",
               {std::max(add.median - alone, 0.0), std::max(add.low - alone, 0.0),
                std::max(add.high - alone, 0.0), add.bursts, add.dropped},
               "too few cores to keep a line busy: fetch-and-add of a remote line less ping-pong "
               "and hit");
}

// Operations at 0, 1, 2... hits are done as long as they begin before the line is gone: of a
// residence of x hits, x + 1/2 on average.
void write_residence(Author& author, const Profile& profile, const std::vector<Place>& places) {
  const std::vector<Cpu> cpus = neighbours(profile, places);
  if (cpus.size() < 2) return;
  const Spread run = measure_run(cpus[0], cpus[1]);
  if (run.bursts == 0) return;
  const auto residence = [&](double in_a_row) { return (in_a_row - 0.5) * profile.rmw_hit; };
  author.write(
      "residence",
      {residence(run.median), residence(run.low), residence(run.high), run.bursts, run.dropped},
      fmt::format("two cores in tight loops get {:.1f} fetch-and-adds done in a row", run.median));
}

void write_wake(Author& author, const std::vector<Place>& places, Calibration& calibration) {
  const auto other = std::ranges::find_if(
      places, [&](const Place& place) { return place.core != places[0].core; });
  if (other == places.end()) return;
  const Wake wake = measure_wake(places[0].cpu, other->cpu);
  author.write("kernel.wake_call", wake.call, "less a call that finds nobody");
  const System system = survey_system();
  constexpr double bare_metal = 3000;
  Spread latency = wake.latency;
  std::string how;
  if (system.virtual_machine && latency.median > 2 * bare_metal) {
    how =
        "on a virtual machine, whose halted core the hypervisor has to start; bare metal takes "
        "3 to 5 us (trial of the model)";
    latency.low = std::min(latency.low, bare_metal);
    calibration.remarks.push_back(fmt::format(
        "waking a thread takes {:.1f} us: this is a virtual machine, whose halted core the "
        "hypervisor has to start; bare metal takes 3 to 5 us",
        latency.median / 1000));
  }
  author.write("kernel.wake_latency", latency, how);
}

}  // namespace

std::vector<Place> survey_places() {
  const HwlocTopology loaded = load_hwloc();
  hwloc_topology_t topology = loaded.get();
  const HwlocSet allowed = allowed_processors(topology);
  std::vector<Place> places;
  for (hwloc_obj_t unit = nullptr;
       (unit = hwloc_get_next_obj_by_type(topology, HWLOC_OBJ_PU, unit)) != nullptr;) {
    if (hwloc_bitmap_isset(allowed.get(), unit->os_index) == 0) continue;
    places.push_back({.cpu = unit->os_index,
                      .core = group_of(topology, HWLOC_OBJ_CORE, unit),
                      .cache = cache_of(topology, unit),
                      .node = group_of(topology, HWLOC_OBJ_NUMANODE, unit),
                      .socket = group_of(topology, HWLOC_OBJ_PACKAGE, unit)});
  }
  if (places.empty()) throw std::runtime_error("hwloc: this process may use no processor");
  return places;
}

bool settle_topology(std::vector<Place>& places, Profile& profile) {
  const auto whole = [](const Place& p) { return std::tuple(p.socket, p.node, p.cache, p.core); };
  std::ranges::stable_sort(places, {}, whole);
  const unsigned sockets = count(places, [](const Place& p) { return p.socket; });
  const unsigned nodes = count(places, [](const Place& p) { return std::tuple(p.socket, p.node); });
  const unsigned caches =
      count(places, [](const Place& p) { return std::tuple(p.socket, p.node, p.cache); });
  const unsigned cores = count(places, whole);
  profile.sockets = sockets;
  profile.nodes_per_socket = nodes / sockets;
  profile.caches_per_node = caches / nodes;
  profile.cores_per_cache = cores / caches;
  profile.smt = static_cast<unsigned>(places.size()) / cores;

  // Sorted, thread i of a regular machine is in group i / size, at every level.
  bool regular = profile.threads() == places.size();
  const auto check = [&](unsigned groups, auto key) {
    const std::size_t size = places.size() / groups;
    for (std::size_t i = 1; regular && i < places.size(); ++i) {
      regular = (key(places[i]) == key(places[i - 1])) == (i % size != 0);
    }
  };
  if (regular) check(sockets, [](const Place& p) { return p.socket; });
  if (regular) check(nodes, [](const Place& p) { return std::tuple(p.socket, p.node); });
  if (regular) {
    check(caches, [](const Place& p) { return std::tuple(p.socket, p.node, p.cache); });
  }
  if (regular) check(cores, whole);
  if (!regular) {
    profile.sockets = profile.nodes_per_socket = profile.caches_per_node = profile.smt = 1;
    profile.cores_per_cache = static_cast<unsigned>(places.size());
    return false;
  }
  // The second threads of all cores come after the first ones.
  std::vector<Place> ordered;
  for (unsigned sibling = 0; sibling < profile.smt; ++sibling) {
    for (unsigned core = 0; core < cores; ++core) {
      ordered.push_back(places[core * profile.smt + sibling]);
    }
  }
  places = std::move(ordered);
  return true;
}

Calibration calibrate(const std::string& name, const std::string& date) {
  Calibration calibration;
  Profile& profile = calibration.profile;
  std::vector<Place> places = survey_places();
  const bool regular = settle_topology(places, profile);
  if (places.size() > max_cores) {
    throw std::runtime_error(fmt::format(
        "this process may use {} hardware threads; a profile has at most {}: bind it to fewer "
        "(taskset)",
        places.size(), max_cores));
  }
  const std::string model = survey_system().cpu_model;
  profile.name = name;
  profile.summary = model.empty() ? "this machine" : model;
  profile.origins["topology"].source =
      regular ? "hwloc" : "hwloc; its groups are not all alike and are left out";
  if (!regular) {
    calibration.remarks.push_back(
        "the groups of cores are not all alike: taken as cores around one cache");
  }

  Author author(profile, date);
  const Alone alone = measure_alone(places[0].cpu);
  write_alone(author, alone);
  calibration.checks.push_back(
      fmt::format("locking and unlocking a free mutex: {:.1f} ns", alone.mutex.median));
  author.assume("overlap", 0.1, 0.1, 0.5, "trial of the model");
  author.assume("read_occupancy", 18, 4, 25,
                "trial of the model; needs more cores than were tried");
  author.assume("turns", 0, 0, 1, "as on meshes; needs more cores than were tried");
  if (profile.threads() < 2) {
    author.assume("conflict", 20, 0, 35, "there is one core");
    calibration.remarks.push_back(
        "one hardware thread: transfers between cores, conflicts and waking another core cannot "
        "be measured; a simulation with this profile has one core");
    return calibration;
  }
  const Distances found = write_transfers(author, profile, places, calibration);
  write_conflict(author, profile, places, found, calibration);
  write_residence(author, profile, places);
  write_wake(author, places, calibration);
  calibration.remarks.push_back(
      "assumed, not measured: overlap, read_occupancy, what an invalidation adds, bypass, turns, "
      "far atomics, futex_wait, quantum" +
      std::string(profile.smt > 1 ? ", smt_slowdown" : ""));
  return calibration;
}

}  // namespace irt::many_core
