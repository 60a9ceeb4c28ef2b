#include "bench/many_core/profiles/profile.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "queues/nearest.hpp"

namespace irt::many_core {
namespace {

using Json = nlohmann::ordered_json;

constexpr double no_default = -1;
constexpr double longest = 1e9;

// What figures() shows, and the value a file may leave out.
struct Row {
  FigureEntry entry;
  double fallback;  ///< or no_default
  std::string_view fallback_source;
};

constexpr std::string_view bare_metal = "trial of the model, bare-metal Linux";

template <Distance level>
double& transfer(Profile& profile) {
  return profile.transfer[static_cast<std::size_t>(level)];
}

#define IRT_MEMBER(name) ([](Profile& p) -> double& { return p.name; })

constexpr std::array rows{
    Row{{"clock_ghz", "clock of a busy core, GHz", 0.1, 20, IRT_MEMBER(clock_ghz)}, no_default, {}},
    Row{{"load_hit", "atomic load of a line the core holds", 0, longest, IRT_MEMBER(load_hit)},
        no_default,
        {}},
    Row{{"store_hit", "store, not waited for", 0, longest, IRT_MEMBER(store_hit)},
        0.4,
        "two-core virtual machine, Emerald Rapids: 0.34"},
    Row{{"rmw_hit", "read-modify-write of a line the core owns", 0, longest, IRT_MEMBER(rmw_hit)},
        no_default,
        {}},
    Row{{"plain_op", "plain access", 0, longest, IRT_MEMBER(plain_op)},
        0.35,
        "assumed: three instructions a cycle at 3 GHz, an access in three of them"},
    Row{{"pause", "the pause instruction", 0, longest, IRT_MEMBER(pause)}, no_default, {}},
    Row{{"transfer.smt_sibling", "line of a sibling thread", 0, longest,
         transfer<Distance::smt_sibling>},
        no_default,
        {}},
    Row{{"transfer.same_cache", "line of a core around the same cache", 0, longest,
         transfer<Distance::same_cache>},
        no_default,
        {}},
    Row{{"transfer.same_node", "line of a core of the same node", 0, longest,
         transfer<Distance::same_node>},
        no_default,
        {}},
    Row{{"transfer.same_socket", "line of a core of another node of the socket", 0, longest,
         transfer<Distance::same_socket>},
        no_default,
        {}},
    Row{{"transfer.other_socket", "line of a core of another socket", 0, longest,
         transfer<Distance::other_socket>},
        no_default,
        {}},
    Row{{"shared_fetch", "factor of a transfer where the copy is clean", 0.01, 2,
         IRT_MEMBER(shared_fetch)},
        0.8,
        "trial of the model"},
    Row{{"dram", "a line that no cache holds", 0, longest, IRT_MEMBER(dram)}, no_default, {}},
    Row{{"home_remote", "added where the line's home is another socket", 0, longest,
         IRT_MEMBER(home_remote)},
        0,
        "core-to-core matrices: no such effect on this kind of machine"},
    Row{{"overlap", "share of a transfer while the line is still busy", 0, 0.95,
         IRT_MEMBER(overlap)},
        0.1,
        "trial of the model, meshes and CCX"},
    Row{{"conflict", "added where other requests wait", 0, longest, IRT_MEMBER(conflict)},
        no_default,
        {}},
    Row{{"residence", "an owner has the line at least", 0, longest, IRT_MEMBER(residence)},
        0,
        "assumed: given up after one operation"},
    Row{{"read_occupancy", "a read keeps the home busy", 0, longest, IRT_MEMBER(read_occupancy)},
        no_default,
        {}},
    Row{{"write_back", "a read of a modified line keeps it busy longer", 0, longest,
         IRT_MEMBER(write_back)},
        0,
        "assumed: written back aside, or not at all (MOESI)"},
    Row{{"invalidate_per_sharer", "added per copy to invalidate", 0, longest,
         IRT_MEMBER(invalidate_per_sharer)},
        3,
        "trial of the model"},
    Row{{"bypass", "requests of the owner's socket that may overtake", 0, 64, IRT_MEMBER(bypass),
         true},
        0,
        "assumed: first come, first served"},
    Row{{"turns", "1: all that wait are served before one is again; 0: any of them is next", 0, 1,
         IRT_MEMBER(turns), true},
        1,
        "wtarreau/atomic-tests, i7-8650U (ring): of load and compare-and-swap by 8 threads 14 % "
        "succeed; in turn 14 %, drawn 25 %"},
    Row{{"far_atomic", "period of a read-modify-write at the home; 0: none", 0, longest,
         IRT_MEMBER(far_atomic)},
        0,
        "atomics are done in the core"},
    Row{{"bus_occupancy", "a transfer keeps its socket's bus busy; 0: no bus", 0, longest,
         IRT_MEMBER(bus_occupancy)},
        0,
        "no front-side bus"},
    Row{{"kernel.syscall", "entering and leaving the kernel", 0, longest, IRT_MEMBER(syscall)},
        125,
        bare_metal},
    Row{{"kernel.futex_wait", "going to sleep", 0, longest, IRT_MEMBER(futex_wait)},
        650,
        bare_metal},
    Row{{"kernel.wake_call", "the waker's share per thread woken", 0, longest,
         IRT_MEMBER(wake_call)},
        1200,
        bare_metal},
    Row{{"kernel.wake_latency", "until the woken thread runs", 0, longest,
         IRT_MEMBER(wake_latency)},
        3000,
        bare_metal},
    Row{{"kernel.switch_same_core", "from one thread to another", 0, longest,
         IRT_MEMBER(switch_same_core)},
        1100,
        "two-core virtual machine"},
    Row{{"kernel.quantum", "a thread runs while others wait", 1000, longest, IRT_MEMBER(quantum)},
        3e6,
        "Linux: 0.75 ms base slice, scaled by 4 for 8 processors and more"},
    Row{{"smt_slowdown", "local work beside a busy sibling", 1, 8, IRT_MEMBER(smt_slowdown)},
        1.45,
        "trial of the model, assumed: 1.3 to 1.6"},
};
#undef IRT_MEMBER

constexpr auto entries = [] {
  std::array<FigureEntry, rows.size()> all{};
  std::ranges::transform(rows, all.begin(), &Row::entry);
  return all;
}();

constexpr std::string_view transfer_prefix = "transfer.";

// The level of a key "transfer.LEVEL".
std::optional<Distance> level_of(std::string_view key) {
  if (!key.starts_with(transfer_prefix)) return std::nullopt;
  for (std::size_t i = 1; i < distances; ++i) {
    const auto level = static_cast<Distance>(i);
    if (key.substr(transfer_prefix.size()) == name_of(level)) return level;
  }
  return std::nullopt;
}

struct Count {
  std::string_view key;
  unsigned Profile::*member;
};
constexpr std::array counts{
    Count{"sockets", &Profile::sockets}, Count{"nodes_per_socket", &Profile::nodes_per_socket},
    Count{"caches_per_node", &Profile::caches_per_node},
    Count{"cores_per_cache", &Profile::cores_per_cache}, Count{"smt", &Profile::smt}};

class Reader {
 public:
  Reader(std::string_view text, std::string_view file) : file_(file) {
    try {
      json_ = Json::parse(text);
    } catch (const Json::exception& error) {
      std::string what = error.what();
      std::ranges::replace(what, '\n', ' ');
      fail_without_key("is no JSON: " + what);
    }
    if (!json_.is_object()) fail_without_key("is no object; a profile is {\"name\": ..., ...}");
  }

  Profile read() {
    check_keys();
    profile_.name = text_of("name");
    profile_.summary = text_of("summary");
    read_topology();
    for (const Row& row : rows) read_figure(row);
    return profile_;
  }

 private:
  [[noreturn]] void fail_without_key(const std::string& what) const {
    throw ProfileError(fmt::format("{}: {}", file_, what));
  }
  [[noreturn]] void fail(std::string_view key, const std::string& what) const {
    throw ProfileError(fmt::format("{}: {}: {}", file_, key, what));
  }

  // Unknown keys are mistakes: a figure that is not read would silently be another.
  void check_keys() const {
    check_keys_of(json_, "", {"name", "summary", "topology", "transfer", "kernel"});
    for (const std::string_view group : {"transfer", "kernel", "topology"}) {
      if (!json_.contains(group)) continue;
      const Json& part = json_[std::string(group)];
      if (!part.is_object()) fail(group, fmt::format("is {}; must be an object", part.dump()));
      check_keys_of(part, std::string(group) + ".", {});
    }
  }

  void check_keys_of(const Json& object, const std::string& prefix,
                     std::vector<std::string_view> known) const {
    if (prefix == "topology.") {
      known = {"cores", "source"};
      for (const Count& count : counts) known.push_back(count.key);
    }
    for (const Row& row : rows) {
      const std::string_view key = row.entry.key;
      const auto dot = key.find('.');
      const bool here = prefix.empty() ? dot == std::string_view::npos : key.starts_with(prefix);
      if (here) known.push_back(key.substr(prefix.size()));
    }
    for (const auto& [key, value] : object.items()) {
      if (std::ranges::find(known, std::string_view(key)) == known.end()) {
        throw ProfileError(fmt::format("{}: {}", file_, unknown_name(prefix + "key", key, known)));
      }
    }
  }

  [[nodiscard]] std::string text_of(std::string_view key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(key, "is missing; must be a text");
    if (!found->is_string() || found->get<std::string>().empty()) {
      fail(key, fmt::format("is {}; must be a text", found->dump()));
    }
    return *found;
  }

  [[nodiscard]] unsigned count_of(const Json& topology, std::string_view key) const {
    const std::string full = "topology." + std::string(key);
    const auto found = topology.find(key);
    if (found == topology.end()) fail(full, "is missing; must be a count, at least 1");
    if (!found->is_number_integer() || *found < 1 || *found > max_cores) {
      fail(full,
           fmt::format("is {}; must be a whole number from 1 to {}", found->dump(), max_cores));
    }
    return found->get<unsigned>();
  }

  void read_topology() {
    const auto found = json_.find("topology");
    if (found == json_.end()) fail("topology", "is missing");
    for (const Count& count : counts) profile_.*count.member = count_of(*found, count.key);
    const unsigned cores = count_of(*found, "cores");
    std::uint64_t product = 1;  // five counts of at most 512 fit
    for (const Count& count : counts) product *= profile_.*count.member;
    if (product > max_cores) {
      fail("topology", fmt::format("makes {} hardware threads; at most {} can be simulated",
                                   product, max_cores));
    }
    if (profile_.cores() != cores) {
      fail("topology.cores",
           fmt::format("is {}, but {} sockets x {} nodes x {} caches x {} cores are {}", cores,
                       profile_.sockets, profile_.nodes_per_socket, profile_.caches_per_node,
                       profile_.cores_per_cache, profile_.cores()));
    }
    const auto source = found->find("source");
    if (source != found->end() && source->is_string())
      profile_.origins["topology"].source = *source;
  }

  [[nodiscard]] const Json* value_at(std::string_view key) const {
    const auto dot = key.find('.');
    const Json* object = &json_;
    if (dot != std::string_view::npos) {
      const auto group = json_.find(key.substr(0, dot));
      if (group == json_.end()) return nullptr;
      object = &*group;
      key.remove_prefix(dot + 1);
    }
    const auto found = object->find(key);
    return found == object->end() ? nullptr : &*found;
  }

  [[nodiscard]] double number(const Row& row, const Json& json) const {
    const FigureEntry& entry = row.entry;
    const double value = json.is_number() ? json.get<double>() : NAN;
    // A number too large for a double is read as infinity.
    if (!std::isfinite(value) || value < entry.least || value > entry.most ||
        (entry.whole && value != std::round(value))) {
      fail(entry.key,
           fmt::format("is {}; must be a {}number from {} to {} ({})", json.dump(),
                       entry.whole ? "whole " : "", entry.least, entry.most, entry.meaning));
    }
    return value;
  }

  void read_figure(const Row& row) {
    const std::string key(row.entry.key);
    const std::optional<Distance> level = level_of(key);
    const Json* json = value_at(key);
    const bool needed = !level || profile_.has(*level);
    if (level && !needed && json != nullptr) {
      fail(key, "no two cores of this topology are that far apart; leave it out");
    }
    if (json == nullptr) {
      if (!needed) return;
      if (row.fallback == no_default) {
        fail(key, fmt::format("is missing; must be [value, \"source\"] ({})", row.entry.meaning));
      }
      row.entry.of(profile_) = row.fallback;
      profile_.origins[key] = {std::string(row.fallback_source), row.fallback, row.fallback, true};
      return;
    }
    const bool shaped = json->is_array() && (json->size() == 2 || json->size() == 4) &&
                        (*json)[1].is_string() && !(*json)[1].get<std::string>().empty();
    if (!shaped) {
      fail(key, fmt::format("is {}; must be [value, \"source\"] or [value, \"source\", low, high]",
                            json->dump()));
    }
    const double value = number(row, (*json)[0]);
    Origin origin{(*json)[1], value, value};
    if (json->size() == 4) {
      origin.low = number(row, (*json)[2]);
      origin.high = number(row, (*json)[3]);
      if (origin.low > value || origin.high < value) {
        fail(key, fmt::format("is {}, outside of its range from {} to {}", value, origin.low,
                              origin.high));
      }
    }
    row.entry.of(profile_) = value;
    profile_.origins[key] = origin;
  }

  std::string file_;
  Json json_;
  Profile profile_;
};

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path)) {
    throw ProfileError(fmt::format("{}: cannot be read; must be a profile", path.string()));
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::string_view name_of(Distance distance) {
  constexpr std::array<std::string_view, distances> names{
      "self", "smt_sibling", "same_cache", "same_node", "same_socket", "other_socket"};
  return names.at(static_cast<std::size_t>(distance));
}

Distance Profile::distance(unsigned a, unsigned b) const {
  if (a == b) return Distance::self;
  if (core_of(a) == core_of(b)) return Distance::smt_sibling;
  if (cache_of(a) == cache_of(b)) return Distance::same_cache;
  if (node_of(a) == node_of(b)) return Distance::same_node;
  if (socket_of(a) == socket_of(b)) return Distance::same_socket;
  return Distance::other_socket;
}

bool Profile::has(Distance distance) const {
  switch (distance) {
    case Distance::self:
      return true;
    case Distance::smt_sibling:
      return smt > 1;
    case Distance::same_cache:
      return cores_per_cache > 1;
    case Distance::same_node:
      return caches_per_node > 1;
    case Distance::same_socket:
      return nodes_per_socket > 1;
    case Distance::other_socket:
      return sockets > 1;
  }
  return false;
}

std::span<const FigureEntry> figures() {
  return entries;
}

Profile parse_profile(std::string_view text, std::string_view file) {
  return Reader(text, file).read();
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(IRT_PROFILES, error)) {
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

std::vector<Profile> profiles() {
  std::vector<Profile> all;
  for (const std::string& name : profile_names()) all.push_back(load_profile(name));
  return all;
}

Profile load_profile(const std::string& name) {
  if (name.find_first_of("./") != std::string::npos) return parse_profile(read_file(name), name);
  const std::vector<std::string> names = profile_names();
  if (std::ranges::find(names, name) == names.end()) {
    const std::vector<std::string_view> known(names.begin(), names.end());
    throw ProfileError(unknown_name("machine", name, known) + "; or give a .json file");
  }
  Profile profile = parse_profile(read_file(std::filesystem::path(IRT_PROFILES) / (name + ".json")),
                                  name + ".json");
  if (profile.name != name) {
    throw ProfileError(
        fmt::format("{}.json: name: is '{}'; must be that of the file", name, profile.name));
  }
  return profile;
}

std::string to_text(const Profile& profile) {
  Json json;
  json["name"] = profile.name;
  json["summary"] = profile.summary;
  json["topology"]["cores"] = profile.cores();
  for (const Count& count : counts)
    json["topology"][std::string(count.key)] = profile.*count.member;
  if (const auto source = profile.origins.find("topology"); source != profile.origins.end()) {
    json["topology"]["source"] = source->second.source;
  }
  Profile copy = profile;  // figures are reached by reference
  std::string text = "{\n";
  for (const Row& row : rows) {
    const auto origin = profile.origins.find(row.entry.key);
    if (origin == profile.origins.end() || origin->second.assumed_by_default) continue;
    const double value = row.entry.of(copy);
    Json figure{value, origin->second.source};
    if (origin->second.low != value || origin->second.high != value) {
      figure.push_back(origin->second.low);
      figure.push_back(origin->second.high);
    }
    const std::string_view key = row.entry.key;
    const auto dot = key.find('.');
    if (dot == std::string_view::npos) {
      json[std::string(key)] = figure;
    } else {
      json[std::string(key.substr(0, dot))][std::string(key.substr(dot + 1))] = figure;
    }
  }
  // One line to each figure, as in the files written by hand.
  std::string separator;
  for (const auto& [key, value] : json.items()) {
    text += separator + "  " + Json(key).dump() + ": ";
    if (value.is_object() && key != "topology") {
      std::string inner = "{\n";
      for (const auto& [name, figure] : value.items()) {
        text += inner + "    " + Json(name).dump() + ": " + figure.dump();
        inner = ",\n";
      }
      text += "\n  }";
    } else {
      text += value.dump();
    }
    separator = ",\n";
  }
  return text + "\n}\n";
}

}  // namespace irt::many_core
