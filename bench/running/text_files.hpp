/// Writing what was measured.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

namespace irt {

/// Makes sure, before anything is measured, that `file` can be written; makes the directories
/// above it. Leaves no new file behind. Throws UsageError.
void require_writable(const std::filesystem::path& file);

/// Replaces the file. "-" is standard output. Throws UsageError.
void write_text(const std::filesystem::path& file, std::string_view text);

/// Where to speak to people while figures go to `file`: standard error where that is "-".
std::FILE* beside(const std::filesystem::path& file);

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// As std::fopen. Throws UsageError.
File open_file(const std::filesystem::path& path, const char* mode);

/// Closes `file`: what is still buffered may fail to reach the disk, too. Throws UsageError.
void finish_file(File file, const std::filesystem::path& path);

}  // namespace irt
