// The page in a real browser: without network, on a phone and on a desk, light and dark.
#include "bench/report/page.hpp"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "bench/report/figures.hpp"
#include "tests/bench/report/browser.hpp"
#include "tests/bench/report/synthetic.hpp"

namespace irt::report {
namespace {

using synthetic::Json;

// Of everything there is something, an injection and a hang among them.
Json all_runs() {
  Json runs = synthetic::sweep({"lock", "lfree", "local", "<script>alert(1)</script>"},
                               {1, 2, 4, 8, 16, 32});
  for (Json& run : synthetic::sweep({"lock", "lfree"}, {1, 4, 16, 64, 256}, "imaginary-256")) {
    runs.push_back(std::move(run));
  }
  Json hung = synthetic::operations("lock", 64, 0);
  hung["status"] = "hung";
  hung["message"] = "</script><img src=x onerror=alert(2)>";
  hung["operations_per_second"] = nullptr;
  runs.push_back(std::move(hung));
  for (const unsigned task_size : {1U, 4U, 16U, 64U, 256U, 1000U}) {
    for (const unsigned threads : {1U, 2U, 4U}) {
      const double size = task_size;
      const double fps = 9.0 * threads * size / (size + 10) * 1000 / (1000 + size);
      runs.push_back(synthetic::frames("lock", threads, task_size, fps));
      runs.push_back(synthetic::frames("lfree", threads, task_size, fps * 1.1));
    }
  }
  return runs;
}

class PageTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::available()) {
      GTEST_SKIP() << "chromium is not installed; 'irt test --full' installs it";
    }
    std::ofstream(directory_ / "runs.json") << all_runs();
    std::ofstream(directory_ / "micro.json")
        << synthetic::micro({"push_pop<lock>", "push_pop<lfree>", "pop_empty<lock>"});
    const std::vector<std::filesystem::path> places{directory_ / "runs.json",
                                                    directory_ / "micro.json"};
    const Results results = read_results(places);
    std::ofstream(page_) << page_of(results, panels_of(results));
    browser_.emplace();
  }

  // For people who want to look at what the tests see.
  void keep_picture(const char* name) {
    const char* kept = std::getenv("IRT_SCREENSHOTS");
    if (kept == nullptr) return;
    std::ofstream(std::filesystem::path(kept) / (std::string(name) + ".base64"))
        << browser_->screenshot(true);
  }

  nlohmann::json ask(const std::string& expression) { return browser_->evaluate(expression); }

  TemporaryDirectory directory_;
  std::filesystem::path page_ = directory_ / "report.html";
  std::optional<Browser> browser_;
};

TEST_F(PageTest, NothingOverflowsAndNothingComplainsAtAnyWidthLightOrDark) {
  for (const int width : {400, 1600}) {
    for (const bool dark : {false, true}) {
      SCOPED_TRACE(testing::Message() << width << (dark ? " dark" : " light"));
      browser_->open(page_, width, 900, dark);
      EXPECT_EQ(ask("innerWidth"), width);
      EXPECT_LE(ask("document.documentElement.scrollWidth"), width);
      EXPECT_GE(ask("document.querySelectorAll('figure svg').length"), 10);
      EXPECT_TRUE(browser_->complaints().empty()) << browser_->complaints().front();
      // No text leaves its picture, or it would be cut off.
      EXPECT_EQ(ask("[...document.querySelectorAll('figure svg text')].filter(text => {"
                    "  const inner = text.getBoundingClientRect();"
                    "  const outer = text.closest('svg').getBoundingClientRect();"
                    "  return inner.left < outer.left - 1 || inner.right > outer.right + 1;"
                    "}).map(text => text.textContent)"),
                nlohmann::json::array());
      const auto background = ask("getComputedStyle(document.body).backgroundColor");
      EXPECT_EQ(background, dark ? "rgb(20, 23, 26)" : "rgb(255, 255, 255)");
      keep_picture((std::to_string(width) + (dark ? "-dark" : "-light")).c_str());
    }
  }
}

TEST_F(PageTest, StringsOfResultsAreNeverMarkup) {
  browser_->open(page_, 1600, 900);
  EXPECT_EQ(ask("document.querySelectorAll('img').length"), 0);
  EXPECT_EQ(ask("document.querySelectorAll('script').length"), 2);
  EXPECT_EQ(ask("[...document.querySelectorAll('.legend button')]"
                ".some(b => b.textContent === '<script>alert(1)</script>')"),
            true);
}

TEST_F(PageTest, ASeriesCanBeSwitchedOffAndOn) {
  browser_->open(page_, 1600, 900);
  const std::string panel =
      "[...document.querySelectorAll('.panel')].find(p => p.textContent.includes('pairs'))";
  const std::string lines =
      panel + ".querySelector('svg[role=img]').querySelectorAll('.line').length";
  const std::string button = panel + ".querySelector('.legend button')";
  EXPECT_EQ(ask(lines), 6);
  ask(button + ".scrollIntoView({block: 'center'})");
  const auto box = ask("(() => { const b = " + button +
                       ".getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; "
                       "})()");
  browser_->click(box[0], box[1]);
  EXPECT_EQ(ask(lines), 5);
  EXPECT_EQ(ask(button + ".getAttribute('aria-pressed')"), "false");
  browser_->click(box[0], box[1]);
  EXPECT_EQ(ask(lines), 6);
}

TEST_F(PageTest, ThePointerShowsValueIntervalAndSamples) {
  browser_->open(page_, 1600, 900);
  EXPECT_EQ(ask("document.getElementById('tip').hidden"), true);
  const std::string mark =
      "[...document.querySelectorAll('.panel')].find(p => p.textContent.includes('pairs'))"
      ".querySelector('[data-series=\"0\"] .mark')";
  ask(mark + ".scrollIntoView({block: 'center'})");
  const auto at = ask("(() => { const b = " + mark +
                      ".getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; "
                      "})()");
  browser_->move_to(at[0], at[1]);
  const auto tip = ask("document.getElementById('tip').innerText").get<std::string>();
  for (const char* part :
       {"lock", "operations [1/s]: 4 M", "threads: 1", "interval: 3.72 M to 4.28 M",
        "3 samples: 3.88 M, 4 M, 4.12 M", "measured"}) {
    EXPECT_NE(tip.find(part), std::string::npos) << part << " is not in " << tip;
  }
  browser_->move_to(1, 1);
  EXPECT_EQ(ask("document.getElementById('tip').hidden"), true);
}

TEST_F(PageTest, TablesSortByNumberWithWhatIsMissingLast) {
  browser_->open(page_, 1600, 900);
  const std::string table =
      "[...document.querySelectorAll('.data')].find(t => t.querySelector('h2').textContent === "
      "'Operations')";
  const std::string column = "[..." + table +
                             ".querySelectorAll('th')].findIndex(h => "
                             "h.textContent === 'operations/s')";
  const std::string cells = "[..." + table +
                            ".querySelectorAll('tbody tr')].map(r => "
                            "r.cells[" +
                            column +
                            "]).map(c => c.title === '' ? c.textContent : "
                            "Number(c.title))";
  for (const bool down : {false, true}) {
    std::string click = table;
    click.append(".querySelectorAll('th button')[").append(column).append("].click()");
    ask(click);
    const auto values = ask(cells);
    ASSERT_GT(values.size(), 20u);
    EXPECT_EQ(values.back(), "not measured");
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const double before = values[i - 1], value = values[i];
      EXPECT_TRUE(down ? before >= value : before <= value) << i;
    }
  }
  EXPECT_EQ(ask(table + ".querySelectorAll('tr.bad').length"), 1);
}

TEST_F(PageTest, SimulatedLinesAreDashedAndSaySo) {
  browser_->open(page_, 1600, 900);
  const std::string simulated = "[...document.querySelectorAll('figure .simulated .line')]";
  EXPECT_GE(ask(simulated + ".length"), 2);
  EXPECT_EQ(ask(simulated + ".every(l => getComputedStyle(l).strokeDasharray !== 'none')"), true);
  EXPECT_EQ(ask("[...document.querySelectorAll('figure .series:not(.simulated) .line')]"
                ".every(l => getComputedStyle(l).strokeDasharray === 'none')"),
            true);
  EXPECT_EQ(ask("[...document.querySelectorAll('.legend button')]"
                ".filter(b => b.querySelector('.simulated'))"
                ".every(b => b.textContent.includes('simulated'))"),
            true);
}

TEST_F(PageTest, ItPrints) {
  browser_->open(page_, 1600, 900, true);
  const std::string pdf = browser_->print();
  EXPECT_TRUE(pdf.starts_with("JVBERi0"));  // "%PDF-"
  EXPECT_GT(pdf.size(), 20'000u);
  if (const char* kept = std::getenv("IRT_SCREENSHOTS")) {
    std::ofstream(std::filesystem::path(kept) / "print.pdf.base64") << pdf;
  }
}

}  // namespace
}  // namespace irt::report
