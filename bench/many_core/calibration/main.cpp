/// `irt calibrate`: measures what the simulator needs to know of this machine.
#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fstream>

#include "bench/many_core/calibration/calibrate.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace irt::many_core {
namespace {

std::string today() {
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::chrono::system_clock::now()));
}

void write(const std::filesystem::path& file, const std::string& text) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written; --out names a file");
}

void print(const Profile& profile) {
  Profile copy = profile;  // figures are reached by reference
  fmt::print("{}: {} sockets x {} nodes x {} caches x {} cores x {} threads\n", profile.summary,
             profile.sockets, profile.nodes_per_socket, profile.caches_per_node,
             profile.cores_per_cache, profile.smt);
  fmt::print("{:<24} {:>10} {:>10} {:>10}  source\n", "figure", "ns", "low", "high");
  for (const FigureEntry& figure : figures()) {
    const auto origin = profile.origins.find(figure.key);
    if (origin == profile.origins.end()) continue;
    fmt::print("{:<24} {:>10.2f} {:>10.2f} {:>10.2f}  {}\n", figure.key, figure.of(copy),
               origin->second.low, origin->second.high, origin->second.source);
  }
}

int run(int argc, char** argv) {
  CLI::App app("Measures single operations on this machine and writes its profile.",
               "irt calibrate");
  std::string name = "calibrated";
  std::filesystem::path out = "irt-out/calibrated.json";
  app.add_option("--name", name, "what the profile is called")->capture_default_str();
  app.add_option("--out", out, "where it is written")->capture_default_str();
  if (const auto code = parse(app, argc, argv)) return *code;
  if (std::filesystem::is_directory(out)) {
    throw std::runtime_error(out.string() + ": is a directory; --out names a file");
  }
  const Calibration calibration = calibrate(name, today());
  print(calibration.profile);
  for (const std::string& check : calibration.checks) fmt::print("check   {}\n", check);
  for (const std::string& remark : calibration.remarks) fmt::print("remark  {}\n", remark);
  write(out, to_text(calibration.profile));
  fmt::print("written to {}; ./irt simulate --machine {}\n", out.string(), out.string());
  return 0;
}

}  // namespace
}  // namespace irt::many_core

int main(int argc, char** argv) {
  return irt::run_program("irt calibrate", [&] { return irt::many_core::run(argc, argv); });
}
