#include "bench/contention/child.hpp"

#include <cstdio>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include "bench/contention/counting.hpp"
#include "bench/contention/measurement.hpp"
#include "bench/frames/child_process.hpp"

namespace irt::contention {

Sample measure_in_child(const std::filesystem::path& program, const Job& job,
                        const std::atomic<bool>& cancel) {
  // The child looks after its threads itself; this is for when it cannot.
  const double allowed =
      job.seconds + job.warmup_seconds + 3 * job.patience_seconds + 0.05 * job.threads + 5;
  const Ending ending = in_child(nlohmann::json(job).dump(), allowed, cancel, [&] {
    execl(program.c_str(), program.c_str(), child_command, nullptr);
    throw std::runtime_error(program.string() + " cannot be started");
  });
  if (ending.status == "ok") return nlohmann::json::parse(ending.answer).get<Sample>();
  Sample sample;
  sample.status = ending.status;
  sample.message = ending.message;
  return sample;
}

int run_as_child() {
  const std::string orders(std::istreambuf_iterator<char>(std::cin), {});
  const auto job = nlohmann::json::parse(orders).get<Job>();
  QueueRegistry queues;
  for (const std::string& plugin : job.plugins) queues.open(plugin);
  const auto answer = [](const Sample& sample) {
    const std::string text =
        nlohmann::json(sample).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  };
  const SubjectMaker make = job.pass == Pass::counted ? counting_subject_maker(job.queue)
                                                      : subject_maker(queues, job.queue);
  const Sample sample = measure(job, make, [&](const Sample& hung) {
    answer(hung);
    _exit(0);  // without waiting for threads that do not end
  });
  answer(sample);
  return 0;
}

}  // namespace irt::contention
