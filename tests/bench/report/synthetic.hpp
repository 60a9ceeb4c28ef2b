/// Results that nobody measured, in the formats of the tools.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace irt::synthetic {

using Json = nlohmann::ordered_json;

/// As `conditions()` gives them.
Json conditions(const std::string& cpu = "Imaginary 9000");

/// One run of `irt bench contention`; of the simulator where `machine` is not empty.
Json operations(const std::string& queue, unsigned threads, double per_second,
                const std::string& machine = "");

/// Runs of `queues`, each with every number of threads.
Json sweep(const std::vector<std::string>& queues, const std::vector<unsigned>& threads,
           const std::string& machine = "");

/// One run of `irt compare`.
Json frames(const std::string& queue, unsigned threads, unsigned task_size, double fps);

/// Google Benchmark's document with three repetitions of each benchmark.
Json micro(const std::vector<std::string>& benchmarks);

}  // namespace irt::synthetic
