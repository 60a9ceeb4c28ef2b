#include "bench/contention/child.hpp"

#include <iostream>
#include <string>
#include <unistd.h>

#include "bench/contention/counting.hpp"
#include "bench/contention/measurement.hpp"
#include "bench/contention/subjects.hpp"

namespace irt::contention {
namespace {

// What the two say to each other, a line each.
constexpr const char* ready_line = "ready";
constexpr const char* go_line = "go\n";

/// Standard output as it was, for the answers: what a queue prints must not be among them.
class Answers {
 public:
  Answers() : descriptor_(dup(STDOUT_FILENO)) { dup2(STDERR_FILENO, STDOUT_FILENO); }
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;
  ~Answers() { close(descriptor_); }

  void say(const std::string& line) const { irt::say(descriptor_, line + '\n'); }
  void say(const Sample& sample) const {
    say(nlohmann::json(sample).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

 private:
  int descriptor_;
};

}  // namespace

MeasuringChild::MeasuringChild(const std::filesystem::path& program, const Job& job)
    : job_(job), process_([&program](int line) {
        speak_by_standard_streams(line);
        become({program.string(), child_command});
      }) {
  process_.tell(nlohmann::json(job).dump() + '\n');
}

// The child looks after its threads itself; this is for when it cannot.
double MeasuringChild::patience() const {
  return 3 * job_.patience_seconds + 0.05 * job_.threads + 5;
}

bool MeasuringChild::ready(const std::atomic<bool>& cancel) {
  return process_.line(job_.warmup_seconds + patience(), cancel) == ready_line;
}

bool MeasuringChild::take_turn(const std::atomic<bool>& cancel) {
  process_.tell(go_line);
  return process_.line(job_.settling_seconds + job_.seconds / job_.turns + patience(), cancel) ==
         ready_line;
}

Sample MeasuringChild::finish(const std::atomic<bool>& cancel) {
  process_.tell(go_line);
  const Ending ending = process_.end(patience(), cancel);
  const auto answer = nlohmann::json::parse(ending.answer, nullptr, false);
  if (answer.is_object()) return answer.get<Sample>();
  Sample sample;
  sample.status = ending.status == "ok" ? "failed" : ending.status;
  sample.message = ending.status == "ok" ? "gave no answer" : ending.message;
  return sample;
}

int run_as_child() {
  const Answers answers;
  std::string line;
  std::getline(std::cin, line);
  const auto job = nlohmann::json::parse(line).get<Job>();
  QueueRegistry queues;
  for (const std::string& plugin : job.plugins) queues.open(plugin);
  const SubjectMaker make = job.pass == Pass::counted ? counting_subject_maker(queues, job.queue)
                                                      : subject_maker(queues, job.queue);
  const auto await_order = [&] {
    answers.say(std::string(ready_line));
    std::getline(std::cin, line);
  };
  answers.say(measure(job, make, await_order, [&](const Sample& hung) {
    answers.say(hung);
    _exit(0);  // without waiting for threads that do not end
  }));
  return 0;
}

}  // namespace irt::contention
