#include "bench/frames/files.hpp"

#include <cerrno>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <png.h>
#include <system_error>

#include "bench/frames/usage_error.hpp"

namespace irt {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

UsageError cannot_write(const std::filesystem::path& file, int error) {
  return UsageError(fmt::format("{}: cannot be written ({}); name a file in a directory of yours",
                                file.string(), std::generic_category().message(error)));
}

File open(const std::filesystem::path& path, const char* mode) {
  File file(std::fopen(path.c_str(), mode));
  if (!file) throw cannot_write(path, errno);
  return file;
}

// What is still buffered may fail to reach the disk, too.
void finish(File file, const std::filesystem::path& path) {
  const bool failed = std::ferror(file.get()) != 0;
  if (std::fclose(file.release()) != 0 || failed) throw cannot_write(path, errno);
}

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
  if (png.info == nullptr) throw cannot_write(path, ENOMEM);
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

void require_writable(const std::filesystem::path& file) {
  if (file == "-") return;
  std::error_code error;
  const bool existed = std::filesystem::exists(file, error);
  if (const auto parent = file.parent_path(); !parent.empty()) {
    std::filesystem::create_directories(parent, error);
    if (error) throw cannot_write(parent, error.value());
  }
  open(file, "ab");
  if (!existed) std::filesystem::remove(file, error);
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  if (path == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  File file = open(path, "wb");
  std::fwrite(text.data(), 1, text.size(), file.get());
  finish(std::move(file), path);
}

void write_png(const std::filesystem::path& path, const Image& image) {
  File file = open(path, "wb");
  write_rows(file.get(), image, path);
  finish(std::move(file), path);
}

}  // namespace irt
