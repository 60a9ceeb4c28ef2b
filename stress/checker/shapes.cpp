#include "stress/checker/shapes.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "stress/checker/clock.hpp"

namespace irt::checker {

Shape parse_shape(std::string_view text) {
  Shape shape;
  std::string_view rest = text;
  const auto check = [text](std::string_view part) {
    for (const char letter : part)
      if (std::string_view("EDRTFSWC").find(letter) == std::string_view::npos)
        throw std::invalid_argument(
            "shape \"" + std::string(text) + "\": '" + letter +
            "' is no step; steps are E D R T F S W C, threads are parted by '|', "
            "a prologue ends with ':', an epilogue follows ';', a capacity '@'");
    return std::string(part);
  };
  if (const auto at = rest.find('@'); at != std::string_view::npos) {
    const std::string_view number = rest.substr(at + 1);
    const auto [end, error] =
        std::from_chars(number.data(), number.data() + number.size(), shape.capacity);
    if (error != std::errc{} || end != number.data() + number.size() || shape.capacity == 0)
      throw std::invalid_argument("shape \"" + std::string(text) +
                                  "\": after '@' comes a capacity in elements, at least 1");
    rest = rest.substr(0, at);
  }
  if (const auto colon = rest.find(':'); colon != std::string_view::npos) {
    shape.prologue = check(rest.substr(0, colon));
    rest.remove_prefix(colon + 1);
  }
  if (const auto semicolon = rest.find(';'); semicolon != std::string_view::npos) {
    shape.epilogue = check(rest.substr(semicolon + 1));
    rest = rest.substr(0, semicolon);
  }
  for (;;) {
    const auto bar = rest.find('|');
    shape.threads.push_back(check(rest.substr(0, bar)));
    if (shape.threads.back().empty())
      throw std::invalid_argument("shape \"" + std::string(text) + "\": a thread without steps");
    if (bar == std::string_view::npos) break;
    rest.remove_prefix(bar + 1);
  }
  if (shape.threads.size() + 1 > max_threads)
    throw std::invalid_argument("shape \"" + std::string(text) + "\": at most " +
                                std::to_string(max_threads - 1) + " threads");
  return shape;
}

std::string to_string(const Shape& shape) {
  std::string text = shape.prologue.empty() ? "" : shape.prologue + ":";
  for (const std::string& thread : shape.threads)
    text += (&thread == shape.threads.data() ? "" : "|") + thread;
  if (!shape.epilogue.empty()) text += ";" + shape.epilogue;
  return shape.capacity == 0 ? text : text + "@" + std::to_string(shape.capacity);
}

std::vector<std::string> battery(const Claims& claims) {
  // Pure consumers matter: a thread that has pushed before it pops has synchronised by that. The
  // middle ones are libvsync's for its unbounded queue; S and W stand for its message passing. The
  // long ones empty a page or a batch of retired nodes, or steal, while another thread holds on to
  // a node. Rings are filled and go round at sizes where narrow counters overflow.
  static const std::vector<std::string> all{
      "F:D@1",    "F:D@2",        "F:D@128",      "F:D@256",      "E|D",      "E:D|D",   "ES|WD",
      "ED|ED",    "E|E|D",        "E|D|D",        "EE|DD",        "E:R|R",    "EE:D|DD", "EES|D|WD",
      "EE:DE|D",  "EE:DD|D",      "E:E|D|E",      "EE|D|D",       "EDD|E",    "E|E|DD",  "EEE|DD",
      "EE:DD|ED", "EEEE:DDDDD|E", "EEEE:DDDD|DE", "EEEEE:DDDD|D", "EEEE|DDDD"};
  std::vector<std::string> fitting;
  for (const std::string& text : all) {
    const Shape shape = parse_shape(text);
    const auto users = [&shape](std::string_view letters) {
      return std::count_if(shape.threads.begin(), shape.threads.end(), [&](const std::string& t) {
        return t.find_first_of(letters) != std::string::npos;
      });
    };
    if (claims.producers == Callers::one && users("ER") > 1) continue;
    if (claims.consumers == Callers::one && users("DR") > 1) continue;
    if (!claims.bounded && shape.capacity != 0) continue;
    fitting.push_back(text);
  }
  return fitting;
}

}  // namespace irt::checker
