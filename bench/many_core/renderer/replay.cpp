#include "bench/many_core/renderer/replay.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/many_core/renderer/replay_client.hpp"
#include "queues/work_queue.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::many_core {
namespace {

class Player final : public ReplayHost {
 public:
  Player(const Profile& profile, const Recording& recording, const ReplayOptions& options,
         std::uint64_t seed)
      : recording_(recording),
        options_(options),
        machine_(profile, place(profile, options.threads, options.placement), seed),
        queue_module_(options.queue_module),
        replay_module_(options.replay_module),
        marks_(options.threads),
        traced_(recording.tasks.size()),
        add_ns_(3 * (options.frame_buffer == "private-sums" ? profile.load_hit : profile.rmw_hit)) {
    choose_contributions();
  }

  nlohmann::json play();

  void generate() override { machine_.work(recording_.generate_ns * options_.scale); }
  void output() override { machine_.work(recording_.output_ns * options_.scale); }
  void trace(std::uint32_t task) override {
    ++traced_[task];
    machine_.work(double{recording_.tasks[task].trace_ns} * options_.scale);
  }
  void shade(std::uint32_t task) override {
    machine_.work(double{recording_.tasks[task].shade_ns} * options_.scale +
                  add_ns_ * contributions_[task].overlapped);
  }
  std::uint32_t pixels(std::uint32_t task, std::uint32_t from, std::uint32_t* to,
                       std::uint32_t room) override {
    const Contributions& mine = contributions_[task];
    const std::uint32_t count = std::min(room, mine.count - from);
    std::copy_n(pixels_.begin() + mine.first + from, count, to);
    return count;
  }
  std::uint32_t first_child(std::uint32_t task) override {
    return recording_.tasks[task].first_child;
  }
  std::uint32_t children(std::uint32_t task) override { return recording_.tasks[task].children; }

  void charge(unsigned worker, Activity activity) override {
    const Time now = machine_.clock();
    if (counting()) {
      spent_[static_cast<std::size_t>(activity)] += now - marks_[worker];
      ++times_[static_cast<std::size_t>(activity)];
    }
    marks_[worker] = now;
  }

  void frame_done() override { ends_.push_back(machine_.clock()); }

 private:
  // What a task adds to the frame buffer on virtual cores, and how much it adds as local work.
  struct Contributions {
    std::uint32_t first = 0, count = 0, overlapped = 0;
  };

  void choose_contributions();
  [[nodiscard]] bool counting() const { return !ends_.empty(); }
  void make();
  void check_conservation(Ending& ending) const;

  const Recording& recording_;
  ReplayOptions options_;
  Machine machine_;
  virtual_cores::Module queue_module_, replay_module_;
  std::vector<Time> marks_;
  std::vector<Time> ends_;  // of frames
  std::array<Time, activities> spent_{};
  std::array<std::uint64_t, activities> times_{};
  std::vector<unsigned> traced_;              // how often, by task
  double add_ns_;                             // a contribution to lines that the core owns
  std::vector<Contributions> contributions_;  // by task
  std::vector<std::uint32_t> pixels_;
  void* shared_ = nullptr;  // not destroyed: the process ends
};

// Contributions that wait for each other, by a lock, are all made one after the other. Others
// overlap: one fetch-and-add of a remote line takes 86 ns, of many in a row 14 each (on a
// two-core virtual machine), which is to say that six are on their way at once. The simulator has
// one at a time, so it is given those to every sixth line.
void Player::choose_contributions() {
  constexpr std::uint32_t in_flight = 6, bytes_per_pixel = 24;
  const std::uint32_t stride = options_.frame_buffer == "spinlock" ? 1 : in_flight;
  for (const RecordedTask& task : recording_.tasks) {
    Contributions mine{.first = static_cast<std::uint32_t>(pixels_.size())};
    for (std::uint32_t i = task.first_pixel; i < task.first_pixel + task.pixels; ++i) {
      const std::uint32_t pixel = recording_.pixels[i];
      if (pixel * bytes_per_pixel / line_bytes % stride == 0) pixels_.push_back(pixel);
    }
    mine.count = static_cast<std::uint32_t>(pixels_.size()) - mine.first;
    mine.overlapped = task.pixels - mine.count;
    contributions_.push_back(mine);
  }
}

void Player::make() {
  const QueueEntry& entry = virtual_cores::queue_of(queue_module_);
  if (options_.threads > 1 && (entry.claims.one_producer() || entry.claims.one_consumer())) {
    throw std::runtime_error("the queue " + std::string(entry.name) +
                             " lets one thread push or pop at a time; it is replayed with one "
                             "thread only");
  }
  if (!entry.claims.allows_workers(options_.threads)) {
    throw std::runtime_error("the queue " + std::string(entry.name) + " is for at most " +
                             std::to_string(entry.claims.max_workers) +
                             " workers; replay it with fewer threads");
  }
  const ReplayPlan plan{
      .host = this,
      .queue = entry.make_task_queue(options_.threads, options_.capacity).release(),
      .frame_buffer = options_.frame_buffer.c_str(),
      .width = recording_.width,
      .height = recording_.height,
      .tasks = static_cast<std::uint32_t>(recording_.tasks.size()),
      .roots = recording_.roots,
      .threads = options_.threads,
      .frames = options_.frames + 1,
      .leave_when_empty = options_.leave_when_empty};
  shared_ = replay_module_.function<decltype(irt_replay_make)>("irt_replay_make")(&plan);
}

// Every task comes out of the queue once per frame.
void Player::check_conservation(Ending& ending) const {
  const unsigned frames = options_.frames + 1;
  const auto wrong = std::ranges::find_if(traced_, [frames](unsigned n) { return n != frames; });
  if (wrong == traced_.end()) return;
  ending = {Ending::Kind::failed, "task " + std::to_string(wrong - traced_.begin()) +
                                      " came out of the queue " + std::to_string(*wrong) +
                                      " times in " + std::to_string(frames) + " frames"};
}

nlohmann::json Player::play() {
  machine_.set_up([this] { make(); });
  // Far more than the slowest queue needs; who is not done by then hangs.
  constexpr double patience = 100;
  const double serial =
      (recording_.work_ns() + recording_.generate_ns + recording_.output_ns) * options_.scale +
      1e3 * static_cast<double>(recording_.tasks.size());
  const auto work = replay_module_.function<decltype(irt_replay_work)>("irt_replay_work");
  Ending ending = machine_.run(0, picoseconds(patience * serial * (options_.frames + 1) + 1e9),
                               [&](unsigned thread) { work(shared_, thread); });
  if (ending.kind == Ending::Kind::finished) check_conservation(ending);
  nlohmann::json result{{"status", ending.kind == Ending::Kind::finished ? "ok"
                                   : ending.kind == Ending::Kind::failed ? "failed"
                                                                         : "hung"},
                        {"message", ending.message}};
  if (ending.kind != Ending::Kind::finished) return result;

  constexpr double seconds = 1e-12;
  const double measured = static_cast<double>(ends_.back() - ends_.front()) * seconds;
  for (std::size_t i = 1; i < ends_.size(); ++i) {
    result["frame_seconds"].push_back(static_cast<double>(ends_[i] - ends_[i - 1]) * seconds);
  }
  result["fps"] = options_.frames / measured;
  result["tasks_per_frame"] = recording_.tasks.size();
  const auto spent = [&](Activity activity) { return spent_[static_cast<std::size_t>(activity)]; };
  const auto share = [&](Time time) {
    return static_cast<double>(time) * seconds / measured / options_.threads;
  };
  const auto mean = [&](Activity activity) {
    const auto times = static_cast<double>(times_[static_cast<std::size_t>(activity)]);
    return times == 0 ? 0 : static_cast<double>(spent(activity)) / times / 1e3;
  };
  result["get_ns"] = mean(Activity::get);
  result["add_ns"] = mean(Activity::add);
  result["share_get"] = share(spent(Activity::get));
  result["share_add"] = share(spent(Activity::add));
  result["share_idle"] = share(spent(Activity::idle));
  result["share_trace"] = share(spent(Activity::trace));
  result["share_shade"] = share(spent(Activity::shade));
  result["share_barrier"] = share(spent(Activity::barrier));
  result["share_serial"] = share(spent(Activity::generate) + spent(Activity::output));
  const Counts& counts = machine_.counts();
  const double tasks =
      static_cast<double>(recording_.tasks.size()) * static_cast<double>(ends_.size());
  const auto swapped = static_cast<double>(counts.swaps);
  result["transfers_per_task"] = static_cast<double>(counts.transfers) / tasks;
  result["sleeps_per_task"] = static_cast<double>(counts.sleeps) / tasks;
  result["cas_failures_per_success"] =
      swapped == 0 ? 0 : static_cast<double>(counts.failed_swaps) / swapped;
  const double whole = static_cast<double>(ends_.back()) * options_.threads;
  for (std::size_t i = 0; i < causes; ++i) {
    result["waiting"][std::string(name_of(static_cast<Cause>(i)))] =
        static_cast<double>(counts.waited[i]) / whole;
  }
  return result;
}

}  // namespace

double clock_scale(const Recording& recording, const Profile& machine) {
  return recording.clock_ghz / machine.clock_ghz;
}

nlohmann::json replay(const Profile& profile, const Recording& recording,
                      const ReplayOptions& options, std::uint64_t seed) {
  Player player(profile, recording, options, seed);
  return player.play();
}

}  // namespace irt::many_core
