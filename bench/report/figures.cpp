#include "bench/report/figures.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <set>

#include "queues/baselines/baselines.hpp"

namespace irt::report {
namespace {

using Runs = std::vector<std::size_t>;  // indices into Results::runs

// With more lines than this nobody follows one of them.
constexpr std::size_t series_at_most = 8;

// Which benchmark, and what of it: "lock/push/threads:2" is about "push", of "lock/threads:2", as
// `irt bench micro` names them; "BM_copy/8" and "BM_copy<int>" are about "BM_copy".
struct MicroName {
  std::string topic, variant;
};
MicroName micro_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const std::size_t first = name.find_first_of("/<");
  if (first == std::string::npos) return {name, name};
  const std::size_t second = name.find('/', first + 1);
  const std::string part = name.substr(first + 1, second - first - 1);
  const bool ours = name[first] == '/' && !part.empty() && letter(part.front()) &&
                    part.find(':') == std::string::npos;
  if (ours) return {part, name.substr(0, first) + name.substr(first + 1 + part.size())};
  std::string variant = name.substr(first + 1);
  if (variant.ends_with('>')) variant.pop_back();
  return {name.substr(0, first), variant};
}

// What is rendered, which scenario, which benchmark: never in one panel.
std::string topic_of(const Run& run) {
  switch (run.family) {
    case Family::frames:
      return run.text("scene");
    case Family::operations:
      return run.text("scenario");
    case Family::micro:
      break;
  }
  return micro_name(run.subject()).topic;
}

// Of runs of one family, what tells them apart beside subject, topic and origin.
std::vector<const Field*> choices(Family family) {
  std::vector<const Field*> found;
  for (const Field& field : results::fields) {
    const bool written = (field.by & tools_of(family)) != 0;
    if (written && field.tells_apart && field.place == results::Place::series) {
      found.push_back(&field);
    }
  }
  return found;
}

// The value of a figure, with what is added to it; nothing where it was not measured.
std::optional<double> value_of(const Run& run, const Field& figure) {
  auto value = run.number(figure);
  if (value && !figure.added.empty()) {
    const auto more = run.number(*results::find(figure.added));
    if (!more) return std::nullopt;
    *value += *more;
  }
  return value;
}

// A choice as part of a name: numbers need their title, words speak for themselves.
std::string described(const Run& run, const Field& choice) {
  const std::string value = run.text(choice);
  if (value.empty()) return fmt::format("{} by default", choice.title);
  return run.number(choice) ? fmt::format("{} {}", choice.title, value) : value;
}

bool is_baseline(const Run& run) {
  const std::vector<std::string> names = baseline_queues();
  return run.family != Family::micro && std::ranges::find(names, run.subject()) != names.end();
}

std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain) {
      name += c;
    } else if (c >= 'A' && c <= 'Z') {
      name += static_cast<char>(c - 'A' + 'a');
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (name.ends_with('-')) name.pop_back();
  return name.substr(0, 100);
}

class PanelMaker {
 public:
  explicit PanelMaker(const Results& results) : results_(results) {
    for (const Run& run : results.runs) {
      if (run.family != Family::micro) colours_.try_emplace(run.subject(), colours_.size());
    }
  }

  std::vector<Panel> make() {
    for (const Family family : {Family::frames, Family::operations, Family::micro}) {
      std::vector<std::string> topics;
      std::map<std::string, Runs> by_topic;
      for (std::size_t i = 0; i < results_.runs.size(); ++i) {
        if (results_.runs[i].family != family) continue;
        Runs& runs = by_topic[topic_of(results_.runs[i])];
        if (runs.empty()) topics.push_back(topic_of(results_.runs[i]));
        runs.push_back(i);
      }
      for (const std::string& topic : topics) {
        if (family == Family::micro) {
          add_micro(topic, by_topic[topic]);
        } else {
          add_topic(family, topic, by_topic[topic]);
        }
      }
    }
    return std::move(panels_);
  }

 private:
  [[nodiscard]] const Run& run(std::size_t index) const { return results_.runs[index]; }

  [[nodiscard]] std::size_t distinct(const Runs& runs, Key key) const {
    std::set<std::string> values;
    for (const std::size_t index : runs) {
      // A simulated run tells only the choices that its model knows.
      const std::string value = run(index).text(key);
      if (!value.empty() || !run(index).simulated()) values.insert(value);
    }
    return values.size();
  }

  void add_topic(Family family, const std::string& topic, const Runs& runs) {
    bool any = false;
    for (const Field* x : choices(family)) {
      if (!x->sweeps || distinct(runs, *x) < 2 || follows(family, runs, *x)) continue;
      add_sweep(family, topic, runs, *x);
      any = true;
    }
    if (!any) add_sweep(family, topic, runs, *choices(family).front());
  }

  // Whether the other choices leave `x` none here, as they do as a rule where it follows from them.
  [[nodiscard]] bool follows(Family family, const Runs& runs, const Field& x) const {
    if (!x.follows) return false;
    std::vector<const Field*> others = choices(family);
    std::erase(others, &x);
    std::map<std::string, std::string> chosen;
    return std::ranges::all_of(runs, [&](std::size_t index) {
      const std::string value = run(index).text(x);
      return chosen.try_emplace(series_key(index, others), value).first->second == value;
    });
  }

  // What tells the runs apart beside the queue and x.
  [[nodiscard]] std::vector<const Field*> differing(Family family, const Runs& runs,
                                                    const Field& x) const {
    std::vector<const Field*> found;
    for (const Field* choice : choices(family)) {
      if (choice != &x && distinct(runs, *choice) > 1) found.push_back(choice);
    }
    const std::vector<const Field*> all = found;
    for (const Field* choice : all) {
      if (!choice->follows) continue;
      std::vector<const Field*> rest = found;
      std::erase(rest, choice);
      std::set<std::string> with, without;
      for (const std::size_t index : runs) {
        with.insert(run(index).text(x) + series_key(index, found));
        without.insert(run(index).text(x) + series_key(index, rest));
      }
      if (with.size() == without.size()) found = std::move(rest);
    }
    return found;
  }

  [[nodiscard]] std::string choices_key(std::size_t index,
                                        const std::vector<const Field*>& kept) const {
    std::string key;
    for (const Field* choice : kept) key += '\n' + run(index).text(*choice);
    return key;
  }
  [[nodiscard]] std::string series_key(std::size_t index,
                                       const std::vector<const Field*>& kept) const {
    const Run& one = run(index);
    return fmt::format("{}\n{}\n{}\n{}{}", one.subject(), one.text("source"), one.text("machine"),
                       one.environment, choices_key(index, kept));
  }

  // Runs with the same key, in the order of their first.
  template <class Key>
  static std::vector<Runs> grouped(const Runs& runs, Key key) {
    std::map<std::string, std::size_t> places;
    std::vector<Runs> groups;
    for (const std::size_t index : runs) {
      const auto [found, is_new] = places.try_emplace(key(index), groups.size());
      if (is_new) groups.emplace_back();
      groups[found->second].push_back(index);
    }
    return groups;
  }

  // Lines of one plot as long as there are few of them; else a panel for each value of a choice.
  void add_sweep(Family family, const std::string& topic, const Runs& runs, const Field& x) {
    std::vector<const Field*> in_series = differing(family, runs, x), in_panel;
    const auto panel_groups = [&] {
      return grouped(runs, [&](std::size_t index) { return choices_key(index, in_panel); });
    };
    const auto series_groups = [&](const Runs& panel) {
      return grouped(panel, [&](std::size_t index) { return series_key(index, in_series); });
    };
    while (!in_series.empty()) {
      std::size_t most = 0;
      for (const Runs& panel : panel_groups()) {
        most = std::max(most, series_groups(panel).size());
      }
      if (most <= series_at_most) break;
      in_panel.push_back(in_series.front());
      in_series.erase(in_series.begin());
    }
    const bool sweeps = distinct(runs, x) > 1;
    for (const Runs& chosen : panel_groups()) {
      if (sweeps && distinct(chosen, x) < 2 && x.key != "threads") continue;
      Panel panel{.family = family,
                  .title = topic,
                  .variant = {},
                  .name = {},
                  .series = {},
                  .plots = {},
                  .facts = facts_of(results_, chosen)};
      panel.title += sweeps ? fmt::format(", over {}", x.title)
                            : fmt::format(", {}", described(run(chosen.front()), x));
      for (const Field* choice : in_panel) {
        if (!panel.variant.empty()) panel.variant += ", ";
        panel.variant += described(run(chosen.front()), *choice);
      }
      const bool one_environment = std::ranges::all_of(chosen, [&](std::size_t index) {
        return run(index).environment == run(chosen.front()).environment;
      });
      for (const Runs& series : series_groups(chosen)) {
        panel.series.push_back(series_of(series, in_series, !one_environment));
      }
      settle_colours(panel);
      add_plots(panel, x);
      add_latencies(panel, x);
      finish(std::move(panel));
    }
  }

  [[nodiscard]] Series series_of(const Runs& runs, const std::vector<const Field*>& in_series,
                                 bool name_environment) const {
    const Run& first = run(runs.front());
    Series series{.name = first.subject(),
                  .simulated = first.simulated(),
                  .baseline = is_baseline(first),
                  .colour = 0,
                  .runs = runs,
                  .facts = series_facts(results_, runs)};
    if (series.baseline) series.name += " (baseline)";
    for (const Field* choice : in_series) {
      if (first.simulated() && first.text(*choice).empty()) continue;
      series.name += ", " + described(first, *choice);
    }
    if (first.simulated()) {
      const std::string machine = first.text("machine");
      series.name += machine.empty() ? ", simulated" : ", simulated " + machine;
    }
    if (name_environment) {
      series.name += fmt::format(" ({})", environment_name(first.environment));
    }
    return series;
  }

  // The colour of its queue, unless that would give two lines of the same kind one colour.
  void settle_colours(Panel& panel) const {
    std::set<std::pair<std::string, bool>> seen;
    bool unique = true;
    for (const Series& series : panel.series) {
      unique &= seen.emplace(run(series.runs.front()).subject(), series.simulated).second;
    }
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      Series& series = panel.series[i];
      series.colour = unique ? colours_.at(run(series.runs.front()).subject()) : i;
    }
  }

  [[nodiscard]] Point point_of(std::size_t index, const Field& figure, double y) const {
    const Run& one = run(index);
    Point point{.x = 0, .y = y, .low = {}, .high = {}, .samples = {}, .run = index};
    if (!figure.low.empty()) {
      point.low = one.number(*results::find(figure.low));
      point.high = one.number(*results::find(figure.high));
    }
    if (figure.key == "fps" && !point.low) {
      point.low = one.number("fps_lower_quartile");
      point.high = one.number("fps_upper_quartile");
    }
    const auto samples = one.fields.find(figure.samples);
    if (samples != one.fields.end() && samples->is_array()) {
      for (const auto& sample : *samples) {
        if (sample.is_number()) point.samples.push_back(sample.get<double>());
      }
    }
    return point;
  }

  // The levels of the simulated machines; with their names where there are several.
  [[nodiscard]] std::vector<Mark> marks_of(const Panel& panel) const {
    std::map<std::string, const Run*> machines;
    for (const Series& series : panel.series) {
      const Run& first = run(series.runs.front());
      if (first.simulated() && first.fields.contains("levels"))
        machines.try_emplace(first.text("machine") + ' ' + first.text("placement"), &first);
    }
    std::vector<Mark> marks;
    for (const auto& [machine, one] : machines) {
      for (const auto& level : one->fields.at("levels")) {
        const auto threads = level.find("threads"), name = level.find("name");
        if (threads == level.end() || !threads->is_number() || name == level.end() ||
            !name->is_string())
          continue;
        const std::string of = machines.size() > 1 ? machine + ": " : "";
        marks.push_back({threads->get<double>(), of + name->get<std::string>()});
      }
    }
    return marks;
  }

  void add_plots(Panel& panel, const Field& x) const {
    for (const Field& figure : results::fields) {
      if (!figure.plotted || (figure.by & tools_of(panel.family)) == 0) continue;
      Plot plot{.name = std::string(figure.key),
                .title = with_unit(figure),
                .x_title = with_unit(x),
                .log_x = false,
                .log_y = false,
                .dots = false,
                .categories = {},
                .lines = {},
                .marks = {}};
      bool only_zeros = true;
      for (const Series& series : panel.series) {
        auto& line = plot.lines.emplace_back();
        for (const std::size_t index : series.runs) {
          const auto y = value_of(run(index), figure);
          const auto at = run(index).number(x);
          if (!y || run(index).status() != "ok") continue;
          line.push_back(point_of(index, figure, *y));
          line.back().x = at.value_or(0);
          only_zeros &= *y == 0;
        }
        std::ranges::sort(line, {}, &Point::x);
      }
      if (x.key == "threads") plot.marks = marks_of(panel);
      if (only_zeros && figure.skip_zeros) continue;
      add(panel, std::move(plot));
    }
  }

  // Percentiles with as many threads as all series have.
  void add_latencies(Panel& panel, const Field& x) const {
    constexpr std::array percentiles{"p50", "p90", "p99", "p99.9", "p99.99", "max"};
    double most = 0;
    for (const Series& series : panel.series) {
      for (const std::size_t index : series.runs) {
        most = std::max(most, run(index).number(x).value_or(0));
      }
    }
    for (const char* operation : {"push", "pop"}) {
      Plot plot{.name = fmt::format("latency-{}", operation),
                .title = fmt::format("latency of {}, {} {:g} [ns]", operation, x.title, most),
                .x_title = "percentile",
                .log_x = false,
                .log_y = false,
                .dots = false,
                .categories = {percentiles.begin(), percentiles.end()},
                .lines = {},
                .marks = {}};
      for (const Series& series : panel.series) {
        auto& line = plot.lines.emplace_back();
        for (const std::size_t index : series.runs) {
          if (run(index).number(x).value_or(0) != most) continue;
          const auto latency = run(index).fields.find("latency_ns");
          if (latency == run(index).fields.end() || !latency->is_object()) continue;
          const auto times = latency->find(operation);
          if (times == latency->end() || !times->is_object()) continue;
          for (std::size_t i = 0; i < percentiles.size(); ++i) {
            const auto time = times->find(percentiles[i]);
            if (time == times->end() || !time->is_number()) continue;
            line.push_back({.x = static_cast<double>(i),
                            .y = time->get<double>(),
                            .low = {},
                            .high = {},
                            .samples = {},
                            .run = index});
          }
        }
      }
      add(panel, std::move(plot));
    }
  }

  // Adds a plot in which there is something, with its axes settled.
  static void add(Panel& panel, Plot plot) {
    std::set<double> places;
    double least_y = 1e300, most_y = 0;
    for (const auto& line : plot.lines) {
      for (const Point& point : line) {
        places.insert(point.x);
        least_y = std::min(least_y, point.y);
        most_y = std::max(most_y, point.y);
      }
    }
    if (places.empty()) return;
    plot.dots = places.size() == 1;
    std::erase_if(plot.marks, [&places](const Mark& mark) {
      return mark.x < *places.begin() || mark.x > *places.rbegin();
    });
    plot.log_x =
        plot.categories.empty() && *places.begin() > 0 && *places.rbegin() >= 16 * *places.begin();
    plot.log_y = least_y > 0 && most_y > 20 * least_y;
    panel.plots.push_back(std::move(plot));
  }

  void add_micro(const std::string& topic, const Runs& runs) {
    Panel panel{.family = Family::micro,
                .title = topic,
                .variant = {},
                .name = {},
                .series = {},
                .plots = {},
                .facts = facts_of(results_, runs)};
    for (const std::size_t index : runs) {
      Series series = series_of({index}, {}, false);
      series.name = micro_name(series.name).variant;
      series.colour = colours_.try_emplace(series.name, colours_.size()).first->second;
      panel.series.push_back(std::move(series));
    }
    add_plots(panel, *results::find("threads"));
    for (Plot& plot : panel.plots) plot.dots = true;
    finish(std::move(panel));
  }

  void finish(Panel panel) {
    if (panel.plots.empty()) return;
    constexpr std::array families{"frames", "operations", "micro"};
    const std::string name = file_name(fmt::format(
        "{} {} {}", families[static_cast<std::size_t>(panel.family)], panel.title, panel.variant));
    const std::size_t same = names_[name]++;
    panel.name = same == 0 ? name : fmt::format("{}-{}", name, same + 1);
    panels_.push_back(std::move(panel));
  }

  const Results& results_;
  std::map<std::string, std::size_t> colours_, names_;
  std::vector<Panel> panels_;
};

}  // namespace

std::vector<Panel> panels_of(const Results& results) {
  return PanelMaker(results).make();
}

}  // namespace irt::report
