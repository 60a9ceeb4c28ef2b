#include "bench/running/text_files.hpp"

#include <cerrno>
#include <fmt/format.h>
#include <system_error>

#include "stress/running/usage_error.hpp"

namespace irt {
namespace {

UsageError cannot_write(const std::filesystem::path& file, int error) {
  return UsageError(fmt::format("{}: cannot be written ({}); name a file in a directory of yours",
                                file.string(), std::generic_category().message(error)));
}

}  // namespace

File open_file(const std::filesystem::path& path, const char* mode) {
  File file(std::fopen(path.c_str(), mode));
  if (!file) throw cannot_write(path, errno);
  return file;
}

void finish_file(File file, const std::filesystem::path& path) {
  const bool failed = std::ferror(file.get()) != 0;
  if (std::fclose(file.release()) != 0 || failed) throw cannot_write(path, errno);
}

void require_writable(const std::filesystem::path& file) {
  if (file == "-") return;
  std::error_code error;
  const bool existed = std::filesystem::exists(file, error);
  if (const auto parent = file.parent_path(); !parent.empty()) {
    std::filesystem::create_directories(parent, error);
    if (error) throw cannot_write(parent, error.value());
  }
  open_file(file, "ab");
  if (!existed) std::filesystem::remove(file, error);
}

std::FILE* beside(const std::filesystem::path& file) {
  return file == "-" ? stderr : stdout;
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  if (path == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  File file = open_file(path, "wb");
  std::fwrite(text.data(), 1, text.size(), file.get());
  finish_file(std::move(file), path);
}

}  // namespace irt
