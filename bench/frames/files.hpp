/// Writing what was measured, pictures included.
#pragma once

#include <filesystem>

#include "bench/running/text_files.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"

namespace irt::frames {

/// Writes a PNG with its gamma noted. Throws UsageError.
void write_png(const std::filesystem::path& file, const Image& image);

}  // namespace irt::frames
