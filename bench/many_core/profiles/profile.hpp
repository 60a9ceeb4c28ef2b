/// A machine as the simulator sees it: how its cores are grouped, and what they pay each other.
///
/// A profile is a JSON file beside this one, some ten lines: a figure is written
/// [value, "source"], or [value, "source", low, high] where sensitivity should try other values
/// than the usual. What a file leaves out has a default, which says so in its source.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace irt::many_core {

/// Hardware threads of a machine, at most.
inline constexpr unsigned max_cores = 512;

/// How far one hardware thread is from another; each level holds all before it.
enum class Distance : std::uint8_t {
  self,
  smt_sibling,   ///< another hardware thread of the same core
  same_cache,    ///< cores around one slice of cache: a CCX, or an L2 of two cores
  same_node,     ///< one die or NUMA node, another slice
  same_socket,   ///< another node of the socket
  other_socket,  ///< over the link or the bus between sockets
};

inline constexpr std::size_t distances = 6;

/// The name of a level in files: "same_cache".
std::string_view name_of(Distance distance);

/// Where a figure comes from, and within what bounds it may lie.
struct Origin {
  std::string source;
  double low = 0, high = 0;  ///< low <= value <= high
  bool assumed_by_default = false;
};

/// All times in nanoseconds.
///
/// Hardware threads are numbered core by core, socket after socket, and within a socket node after
/// node, and within a node cache after cache; the second threads of all cores follow when every
/// core has one (as Linux numbers most machines). So threads 0 to n - 1 are the closest n there
/// are, and share no core before they must.
struct Profile {
  std::string name, summary;

  // Topology: sockets x nodes x caches x cores x threads.
  unsigned sockets = 1, nodes_per_socket = 1, caches_per_node = 1, cores_per_cache = 1, smt = 1;

  double clock_ghz = 0;  ///< of a busy core; scales work that was measured elsewhere

  // What a core does alone.
  double load_hit = 0;   ///< atomic load of a line it holds
  double store_hit = 0;  ///< store, which it need not wait for
  double rmw_hit = 0;    ///< read-modify-write of a line it owns
  double plain_op = 0;   ///< plain access, overlapped with its neighbours
  double pause = 0;      ///< the instruction that spinning loops wait with

  /// A line from the core that owns it to the one that asks, one way; by distance.
  std::array<double, distances> transfer{};
  double shared_fetch = 0;  ///< factor of a transfer where the copy is clean
  double dram = 0;          ///< a line that no cache holds
  /// Added to a transfer within a socket, but not within a cache, where the line's home is another
  /// socket: the request goes through the home's directory.
  double home_remote = 0;
  double overlap = 0;   ///< share of a transfer that passes while the line is still busy
  double conflict = 0;  ///< added to a transfer where other requests wait for the line
  /// How long a core that was given a line to write has it at least, whoever asks: operations that
  /// follow at once are hits.
  double residence = 0;
  double read_occupancy = 0;  ///< how long a read keeps the line's home busy
  double write_back = 0;      ///< added to that of a modified line, which goes to memory, too
  double invalidate_per_sharer = 0;
  double bypass = 0;         ///< requests of the owner's socket that may overtake another socket's
  double turns = 1;          ///< 1: of those that wait all are served before one is again; 0: any
  double far_atomic = 0;     ///< period of a read-modify-write done at the home; 0: in the core
  double bus_occupancy = 0;  ///< how long a transfer keeps its socket's front-side bus; 0: no bus

  // What the kernel does.
  double syscall = 0;           ///< entering and leaving it
  double futex_wait = 0;        ///< going to sleep
  double wake_call = 0;         ///< the waker's share, per thread that is woken
  double wake_latency = 0;      ///< from there until the woken thread runs on an idle core
  double switch_same_core = 0;  ///< from one thread to another on one core
  double quantum = 0;           ///< how long a thread runs while others wait for its core

  double smt_slowdown = 1;  ///< factor of local work while a sibling works, too

  /// By the names of figures(): "transfer.same_cache".
  std::map<std::string, Origin, std::less<>> origins;

  [[nodiscard]] unsigned cores() const {
    return sockets * nodes_per_socket * caches_per_node * cores_per_cache;
  }
  [[nodiscard]] unsigned threads() const { return cores() * smt; }

  [[nodiscard]] unsigned core_of(unsigned thread) const { return thread % cores(); }
  [[nodiscard]] unsigned cache_of(unsigned thread) const {
    return core_of(thread) / cores_per_cache;
  }
  [[nodiscard]] unsigned node_of(unsigned thread) const {
    return cache_of(thread) / caches_per_node;
  }
  [[nodiscard]] unsigned socket_of(unsigned thread) const {
    return node_of(thread) / nodes_per_socket;
  }

  [[nodiscard]] Distance distance(unsigned a, unsigned b) const;
  /// One way from `a` to `b`; 0 for a == b.
  [[nodiscard]] double transfer_between(unsigned a, unsigned b) const {
    return transfer[static_cast<std::size_t>(distance(a, b))];
  }
  /// Whether this machine has two threads at that distance.
  [[nodiscard]] bool has(Distance distance) const;
};

/// One figure of a profile, as files and sensitivity name it.
struct FigureEntry {
  std::string_view key;  ///< "kernel.syscall"
  std::string_view meaning;
  double least, most;
  double& (*of)(Profile&);
  bool whole = false;  ///< takes whole numbers only
};

/// Every figure a profile has, in the order of files. Topology is none: it does not vary.
std::span<const FigureEntry> figures();

/// `what()` is one line: file, key, what is wrong, what would be right. Ends in exit code 2.
struct ProfileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a profile; `file` is for messages. Throws ProfileError.
Profile parse_profile(std::string_view text, std::string_view file);

/// The names of the profiles that come with the project, sorted.
std::vector<std::string> profile_names();

/// The profiles that come with the project, by name. Throws ProfileError.
std::vector<Profile> profiles();

/// The profile `name`, or the one in a file if there is a dot or a slash in `name`. Throws
/// ProfileError; where there is no such profile it names the nearest.
Profile load_profile(const std::string& name);

/// As a file: what parse_profile reads.
std::string to_text(const Profile& profile);

}  // namespace irt::many_core
