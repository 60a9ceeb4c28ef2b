#include "tests/bench/report/browser.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace irt::report {
namespace {

constexpr int patience_ms = 100'000;

std::filesystem::path chromium() {
  const char* path = std::getenv("PATH");
  std::istringstream directories(path != nullptr ? path : "");
  for (std::string directory; std::getline(directories, directory, ':');) {
    auto file = std::filesystem::path(directory) / "chromium";
    if (access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

}  // namespace

bool Browser::available() {
  return !chromium().empty();
}

// The browser reads commands from descriptor 3 and answers on 4.
Browser::Browser() {
  std::signal(SIGPIPE, SIG_IGN);  // a browser that died is an error, not the end of the test
  int commands[2], answers[2];
  if (pipe(commands) != 0 || pipe(answers) != 0) throw std::runtime_error("pipe");
  std::vector<std::string> words{chromium().string(),
                                 "--headless",
                                 "--disable-gpu",
                                 "--no-first-run",
                                 "--hide-scrollbars",
                                 "--host-resolver-rules=MAP * ~NOTFOUND",
                                 "--user-data-dir=" + (profile_ / "profile").string(),
                                 "--remote-debugging-pipe"};
  if (geteuid() == 0) words.emplace_back("--no-sandbox");
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  child_ = fork();
  if (child_ == 0) {
    // Out of the way of 3 and 4 first.
    const int in = fcntl(commands[0], F_DUPFD, 10), out = fcntl(answers[1], F_DUPFD, 10);
    dup2(in, 3);
    dup2(out, 4);
    for (int descriptor = 5; descriptor < 64; ++descriptor) close(descriptor);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (int descriptor = 0; descriptor < 3; ++descriptor) dup2(nowhere, descriptor);
    setpgid(0, 0);
    execv(arguments[0], arguments.data());
    _exit(99);
  }
  close(commands[0]);
  close(answers[1]);
  to_ = commands[1];
  from_ = answers[0];
  const auto target = call("Target.createTarget", {{"url", "about:blank"}});
  const auto attached =
      call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}});
  session_ = attached.at("sessionId").get<std::string>();
  for (const char* domain : {"Page", "Runtime", "Log", "Network"}) {
    call(std::string(domain) + ".enable");
  }
  call("Network.emulateNetworkConditions",
       {{"offline", true}, {"latency", 0}, {"downloadThroughput", 0}, {"uploadThroughput", 0}});
}

Browser::~Browser() {
  try {
    session_.clear();
    call("Browser.close");
  } catch (const std::exception&) {
    // It is killed below.
  }
  close(to_);
  close(from_);
  for (int i = 0; i < 100 && waitpid(child_, nullptr, WNOHANG) == 0; ++i) usleep(50'000);
  kill(-child_, SIGKILL);
  waitpid(child_, nullptr, WNOHANG);
}

void Browser::open(const std::filesystem::path& page, int width, int height, bool dark) {
  complaints_.clear();
  loaded_ = false;
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  call("Emulation.setEmulatedMedia",
       {{"features", {{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}}}});
  call("Page.navigate", {{"url", "file://" + std::filesystem::absolute(page).string()}});
  while (!loaded_) note(receive());
}

nlohmann::json Browser::evaluate(const std::string& expression) {
  const auto answer =
      call("Runtime.evaluate",
           {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (answer.contains("exceptionDetails")) {
    throw std::runtime_error(answer.at("exceptionDetails").dump());
  }
  return answer.at("result").value("value", nlohmann::json());
}

void Browser::mouse(const char* type, double x, double y, int clicks) {
  call("Input.dispatchMouseEvent", {{"type", type},
                                    {"x", x},
                                    {"y", y},
                                    {"button", clicks > 0 ? "left" : "none"},
                                    {"clickCount", clicks}});
}

void Browser::move_to(double x, double y) {
  mouse("mouseMoved", x, y, 0);
}

void Browser::click(double x, double y) {
  mouse("mousePressed", x, y, 1);
  mouse("mouseReleased", x, y, 1);
}

std::string Browser::screenshot(bool whole_page) {
  return call("Page.captureScreenshot", {{"captureBeyondViewport", whole_page}})
      .at("data")
      .get<std::string>();
}

std::string Browser::print() {
  return call("Page.printToPDF", {{"printBackground", true}, {"preferCSSPageSize", true}})
      .at("data")
      .get<std::string>();
}

nlohmann::json Browser::call(const std::string& method, nlohmann::json parameters) {
  nlohmann::json message{{"id", ++last_id_}, {"method", method}};
  message["params"] = parameters.is_null() ? nlohmann::json::object() : std::move(parameters);
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump();
  // The message and the zero byte that ends it.
  if (write(to_, text.c_str(), text.size() + 1) != static_cast<ssize_t>(text.size() + 1)) {
    throw std::runtime_error("the browser takes no commands");
  }
  while (true) {
    nlohmann::json answer = receive();
    if (answer.value("id", 0) != last_id_) {
      note(answer);
      continue;
    }
    if (answer.contains("error")) throw std::runtime_error(method + answer.at("error").dump());
    return answer.at("result");
  }
}

nlohmann::json Browser::receive() {
  std::size_t end = 0;
  while ((end = buffer_.find('\0')) == std::string::npos) {
    pollfd ready{from_, POLLIN, 0};
    char bytes[65536];
    const ssize_t got =
        poll(&ready, 1, patience_ms) > 0 ? read(from_, bytes, sizeof bytes) : ssize_t{0};
    if (got <= 0) throw std::runtime_error("the browser does not answer");
    buffer_.append(bytes, static_cast<std::size_t>(got));
  }
  auto message = nlohmann::json::parse(buffer_.substr(0, end));
  buffer_.erase(0, end + 1);
  return message;
}

void Browser::note(const nlohmann::json& event) {
  const std::string method = event.value("method", "");
  const nlohmann::json parameters = event.value("params", nlohmann::json::object());
  if (method == "Page.loadEventFired") loaded_ = true;
  const bool complains =
      method == "Runtime.exceptionThrown" ||
      (method == "Runtime.consoleAPICalled" && parameters.value("type", "") == "error") ||
      (method == "Log.entryAdded" && parameters.at("entry").value("level", "") == "error");
  if (complains) complaints_.push_back(parameters.dump());
  if (method == "Network.requestWillBeSent") {
    const auto url = parameters.at("request").at("url").get<std::string>();
    if (!url.starts_with("file:")) complaints_.push_back("request: " + url);
  }
}

}  // namespace irt::report
