/// Chromium without a window, driven over its DevTools protocol through a pipe.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/types.h>
#include <vector>

#include "tests/bench/temporary.hpp"

namespace irt::report {

/// One page at a time. Every call throws std::runtime_error where the browser does not answer
/// within two minutes.
class Browser {
 public:
  /// Whether there is one on this machine.
  static bool available();

  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Loads a file without network, as wide as asked, and waits until it is loaded.
  void open(const std::filesystem::path& page, int width, int height, bool dark = false);

  /// The value of an expression in the page.
  nlohmann::json evaluate(const std::string& expression);

  /// Moves the mouse to a place in the window, in pixels; or clicks there.
  void move_to(double x, double y);
  void click(double x, double y);

  /// Errors of the console, exceptions and requests to a network since the page was opened.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

  std::string screenshot(bool whole_page);  ///< a PNG in base64
  std::string print();                      ///< a PDF in base64

 private:
  nlohmann::json call(const std::string& method, nlohmann::json parameters = {});
  nlohmann::json receive();
  void note(const nlohmann::json& event);
  void mouse(const char* type, double x, double y, int clicks);

  TemporaryDirectory profile_;
  pid_t child_ = 0;
  int to_ = -1, from_ = -1;
  std::string buffer_, session_;
  int last_id_ = 0;
  bool loaded_ = false;
  std::vector<std::string> complaints_;
};

}  // namespace irt::report
