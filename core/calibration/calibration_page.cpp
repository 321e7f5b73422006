#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/calibration/ageing.h"
#include "core/calibration/calibration_report.h"
#include "core/calibration/camera_section.h"
#include "core/output/dimming.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

/// One plot: x in `width`, rows or height given by what it draws.
constexpr double kWidth = 640, kLeft = 150, kRight = 60, kRow = 18;

double x_of(double share, double most) {
  return kLeft + (kWidth - kLeft - kRight) * std::clamp(share / most, 0.0, 1.0);
}

std::string opened(double height, const char* says) {
  return fmt::format("<svg viewBox=\"0 0 {:g} {:g}\" role=\"img\" aria-label=\"{}\">\n", kWidth, height, says);
}

/// Per goal, how well its light was and is known.
std::string goals_plot(const CalibrationReport& report) {
  double most = 0.01;
  for (const auto& goal : report.goals)
    most = std::max({most, goal.stated.share_of_error(), goal.found.share_of_error()});
  std::string svg = opened(kRow * (static_cast<double>(report.goals.size()) + 1), "error of the light at each goal");
  double y = kRow;
  for (const auto& goal : report.goals) {
    const double stated = goal.stated.share_of_error(), found = goal.found.share_of_error();
    svg += fmt::format(
        "<text x=\"{0:g}\" y=\"{1:g}\" text-anchor=\"end\">{2}</text>"
        "<rect class=\"before\" x=\"{3:g}\" y=\"{4:g}\" width=\"{5:.1f}\" height=\"9\"/>"
        "<rect class=\"now\" x=\"{3:g}\" y=\"{4:g}\" width=\"{6:.1f}\" height=\"9\"/>"
        "<text x=\"{7:.1f}\" y=\"{1:g}\">{8:.1f} %</text>\n",
        kLeft - 8, y, escaped_for_markup(goal.point), kLeft, y - 9, x_of(stated, most) - kLeft,
        x_of(found, most) - kLeft, x_of(std::max(stated, found), most) + 5, 100 * found);
    y += kRow;
  }
  return svg + "</svg>\n";
}

/// Readings: how far each is off, in standard errors.
std::string readings_plot(const CalibrationReport& report) {
  constexpr double kHeight = 170, kMost = 6, kTop = 10, kBottom = 24;
  const auto y_of = [&](double errors) {
    return kTop + (kHeight - kTop - kBottom) * (0.5 - std::clamp(errors, -kMost, kMost) / (2 * kMost));
  };
  std::string svg = opened(kHeight, "how far each reading is off, in standard errors");
  for (const double line : {-4.0, -2.0, 0.0, 2.0, 4.0})
    svg += fmt::format(
        "<line class=\"grid\" x1=\"40\" x2=\"{0:g}\" y1=\"{1:.1f}\" y2=\"{1:.1f}\"/>"
        "<text x=\"34\" y=\"{2:.1f}\" text-anchor=\"end\">{3:+g}</text>\n",
        kWidth - 10, y_of(line), y_of(line) + 4, line);
  const double step = (kWidth - 60) / static_cast<double>(std::max<std::size_t>(report.readings.size(), 1));
  double x = 46;
  for (const auto& reading : report.readings) {
    svg += fmt::format(
        "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"><title>{}, at {}: read {:.2f} lx, explained {:.2f} "
        "lx</title></circle>\n",
        std::abs(reading.in_errors) > kOddReading ? "odd" : "fits", x, y_of(reading.in_errors),
        escaped_for_markup(reading.light), escaped_for_markup(reading.at), reading.lux, reading.explained_lx);
    x += step;
  }
  return svg +
         fmt::format("<text x=\"40\" y=\"{:g}\">readings in the order they were taken</text></svg>\n", kHeight - 6);
}

/// Share of full light over level, of every lamp whose curve was measured.
std::string curves_plot(const Calibration& found) {
  constexpr double kSide = 220, kEdge = 34;
  const auto at = [&](double level, double share) {
    return fmt::format("{:.1f},{:.1f} ", kEdge + level * (kSide - kEdge - 6), (kSide - kEdge) * (1 - share) + 6);
  };
  std::string svg = fmt::format(
      "<svg class=\"small\" viewBox=\"0 0 {0:g} {0:g}\" role=\"img\" aria-label=\"dimmer curves\">\n", kSide);
  svg += fmt::format("<polyline class=\"grid\" points=\"{}{}\"/>\n", at(0, 0), at(1, 1));
  for (const CalibratedFixture& fixture : found.fixtures) {
    if (fixture.curve.empty()) continue;
    std::string points = at(0, 0);
    for (const auto& [level, share] : fixture.curve) points += at(level, share);
    svg += fmt::format("<polyline class=\"curve\" points=\"{}\"><title>{}</title></polyline>\n", points,
                       escaped_for_markup(fixture.name));
  }
  return svg +
         fmt::format(
             "<text x=\"{:g}\" y=\"{:g}\" text-anchor=\"end\">level</text><text x=\"2\" y=\"12\">light</text></svg>\n",
             kSide - 4, kSide - 8);
}

std::string list_of(const std::vector<std::string>& sentences) {
  std::string html = "<ul>\n";
  for (const std::string& sentence : sentences) html += "<li>" + escaped_for_markup(sentence) + "</li>\n";
  return html + "</ul>\n";
}

std::string fixtures_table(const Calibration& found) {
  const bool aged = std::any_of(found.fixtures.begin(), found.fixtures.end(),
                                [](const CalibratedFixture& fixture) { return ageing_of(fixture).has_value(); });
  std::string html = fmt::format(
      "<table><tr><th>fixture</th><th>output over rated</th>{}<th>moved</th><th>turned</th>"
      "<th>at half level</th></tr>\n",
      aged ? "<th>ageing</th>" : "");
  for (const CalibratedFixture& fixture : found.fixtures) {
    const std::string output = fixture.output.standard_error > 0
                                   ? fmt::format("{:.3f} ± {:.3f}", fixture.output.value, fixture.output.standard_error)
                                   : "not measured";
    const std::string curve = fixture.curve.empty()
                                  ? "not measured"
                                  : fmt::format("{:.0f} % of its light", 100 * share_at_level(fixture.curve, 0.5));
    const std::string ageing = aged ? "<td>" + escaped_for_markup(ageing_words(fixture)) + "</td>" : "";
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td>{}<td>{:.1f} ± {:.1f} cm</td><td>{:.1f} ± {:.1f}°</td><td>{}</td></tr>\n",
        escaped_for_markup(fixture.name), output, ageing, 100 * fixture.offset_m.norm(),
        100 * fixture.offset_error_m.norm(), fixture.turn_deg.norm(), fixture.turn_error_deg.norm(), curve);
  }
  return html + "</table>\n";
}

template <class Named, class Value>
std::string ratios_table(const char* of, const char* what, const std::vector<Named>& all, Value value) {
  std::string html = fmt::format("<table><tr><th>{}</th><th>{}</th></tr>\n", of, what);
  for (const Named& each : all)
    html += fmt::format("<tr><td>{}</td><td>{:.3f} ± {:.3f}</td></tr>\n", escaped_for_markup(each.name),
                        value(each).value, value(each).standard_error);
  return html + "</table>\n";
}

std::string goals_table(const CalibrationReport& report) {
  std::string html =
      "<table><tr><th>goal</th><th>by the rig file</th><th>as found</th><th>the file was off by</th></tr>\n";
  for (const auto& goal : report.goals)
    html += fmt::format(
        "<tr><td>{}</td><td>{:.1f} ± {:.1f} lx</td><td>{:.1f} ± {:.1f} lx</td><td>{:+.0f} %</td></tr>\n",
        escaped_for_markup(goal.point), goal.stated.lux, goal.stated.standard_error_lx, goal.found.lux,
        goal.found.standard_error_lx, goal.found.lux > 0 ? 100 * (goal.stated.lux / goal.found.lux - 1) : 0);
  return html + "</table>\n";
}

constexpr const char* kStyle =
    "body { font: 15px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 1.5rem auto; padding: 0 1rem; color: "
    "#222; "
    "background: #fff; }\n"
    "h1 { font-size: 1.3rem; } h2 { font-size: 1rem; margin: 1.6rem 0 0.4rem; }\n"
    ".wide { overflow-x: auto; } table { border-collapse: collapse; }\n"
    "th, td { padding: 0.15rem 1rem 0.15rem 0; text-align: left; white-space: nowrap; } th { font-weight: 600; }\n"
    "table.words td:first-child { white-space: normal; min-width: 9rem; }\n"
    "svg { width: 100%; max-width: 44rem; height: auto; } svg.small { max-width: 20rem; }\n"
    "img { display: block; max-width: 100%; height: auto; margin: 0.6rem 0; }\n"
    "summary { cursor: pointer; padding: 0.6rem 0; }\n"
    "svg text { font-size: 11px; fill: currentColor; } .grid { stroke: #999; stroke-width: 0.5; fill: none; }\n"
    ".before { fill: #c8c8c8; } .now, .fits { fill: #1668b4; } .odd { fill: #c33; }\n"
    ".curve { fill: none; stroke: #1668b4; stroke-width: 1.2; } .curve:hover { stroke-width: 3; }\n"
    "@media (prefers-color-scheme: dark) { body { color: #ddd; background: #181818; } .before { fill: #555; }\n"
    ".now, .fits { fill: #6db3f2; } .curve { stroke: #6db3f2; } .odd { fill: #ff7a7a; } }\n";

}  // namespace

std::string to_html(const CalibrationReport& report) {
  const Calibration& found = report.found;
  std::string by;
  for (const std::string& means : report.by) by += (by.empty() ? "" : " and ") + means;
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>Calibration of {0}</title>\n<style>\n{1}</style>"
      "</head><body>\n<h1>Calibration of {0}</h1>\n<p>Made {2}, by {3}. ± is one standard error.</p>\n",
      escaped_for_markup(found.rig), kStyle, escaped_for_markup(found.made), escaped_for_markup(by));
  html += fmt::format(
      "<h2>How well the light at the goals is known</h2>\n<p>Every lamp at {:.0f} % of its light. Grey: before, blue: "
      "now.</p>\n{}<div class=\"wide\">\n{}</div>\n",
      100 * report.level, goals_plot(report), goals_table(report));
  html += camera_section(report);
  html += "<h2>Not found out</h2>\n";
  html += report.not_found.empty() ? "<p>Nothing is left open.</p>\n" : list_of(report.not_found);
  if (!report.to_settle.empty()) {
    std::string points;
    for (const std::string& point : report.to_settle) points += (points.empty() ? "\"" : ", \"") + point + "\"";
    html += fmt::format("<p>A luxmeter at {} would settle most of the rest: luxrig calibrate --hand.</p>\n",
                        escaped_for_markup(points));
  }
  html += "<h2>Lamps</h2>\n<div class=\"wide\">\n" + fixtures_table(found) + "</div>\n<p>Dimmer curves:</p>\n" +
          curves_plot(found);
  html +=
      "<h2>How well the readings agree</h2>\n<p>Each reading, less what is now explained, in standard errors.</p>\n" +
      readings_plot(report);
  html += "<h2>Luxmeters</h2>\n<div class=\"wide\">\n" +
          ratios_table("luxmeter", "reading over light", found.luxmeters,
                       [](const CalibratedLuxmeter& meter) { return meter.gain; }) +
          "</div>\n<h2>Paint</h2>\n<div class=\"wide\">\n" +
          ratios_table("material", "true over stated reflectance", found.materials,
                       [](const CalibratedMaterial& material) { return material.reflectance; }) +
          "</div>\n";
  return html + "</body></html>\n";
}

}  // namespace luxrig
