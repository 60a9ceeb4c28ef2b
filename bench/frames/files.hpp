/// Writing what was measured.
#pragma once

#include <filesystem>
#include <string_view>

#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt {

/// Makes sure, before anything is measured, that `file` can be written; makes the directories
/// above it. Leaves no new file behind. Throws UsageError.
void require_writable(const std::filesystem::path& file);

/// Replaces the file. "-" is standard output. Throws UsageError.
void write_text(const std::filesystem::path& file, std::string_view text);

/// Writes a PNG with its gamma noted. Throws UsageError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace irt
