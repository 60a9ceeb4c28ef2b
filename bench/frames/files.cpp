#include "bench/frames/files.hpp"

#include <cstdio>
#include <png.h>
#include <utility>

#include "stress/running/usage_error.hpp"

namespace irt::frames {
namespace {

void write_rows(std::FILE* file, const Image& image, const std::filesystem::path& path) {
  struct Png {
    png_structp writer = nullptr;
    png_infop info = nullptr;
    ~Png() { png_destroy_write_struct(&writer, &info); }
  } png;
  // libpng reports errors by calling a function that must not return; an exception does not.
  png.writer = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, nullptr,
      [](png_structp, png_const_charp message) { throw UsageError(message); },
      [](png_structp, png_const_charp) {});
  if (png.writer != nullptr) png.info = png_create_info_struct(png.writer);
  if (png.info == nullptr) throw UsageError(path.string() + ": cannot be written (out of memory)");
  png_init_io(png.writer, file);
  png_set_IHDR(png.writer, png.info, image.width, image.height, 8, PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_gAMA(png.writer, png.info, 0.5);
  png_write_info(png.writer, png.info);
  for (std::size_t row = 0; row < image.height; ++row) {
    png_write_row(png.writer, image.rgb.data() + row * image.width * 3);
  }
  png_write_end(png.writer, nullptr);
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  File file = open_file(path, "wb");
  write_rows(file.get(), image, path);
  finish_file(std::move(file), path);
}

}  // namespace irt::frames
