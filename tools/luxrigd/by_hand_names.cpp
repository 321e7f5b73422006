#include "tools/luxrigd/by_hand_names.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>

#include "core/rig/housing.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

bool is_called(const std::string& name, const std::string& wanted) {
  return name == wanted || fnmatch(wanted.c_str(), name.c_str(), 0) == 0;
}

std::vector<ByHand> fixtures_like(const Rig& rig, const std::string& wanted) {
  std::vector<ByHand> found;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const auto& housing = rig.fixtures[f].housing;
    const bool whole = housing && is_called(housing_name(rig, f), wanted);
    ByHand one{ByHand::What::level, f};
    one.whole_housing = whole;
    if (whole ? *housing == f : is_called(rig.fixtures[f].name, wanted)) found.push_back(one);
  }
  return found;
}

std::vector<ByHand> points_like(const Rig& rig, const std::string& wanted) {
  std::vector<ByHand> found;
  for (std::size_t p = 0; p < rig.points.size(); ++p)
    if (is_called(rig.points[p].name, wanted)) found.push_back({ByHand::What::goal, p});
  return found;
}

template <class Find>
Result<std::vector<ByHand>> all_called(const std::vector<std::string>& names, const char* of_what,
                                       const std::vector<std::string_view>& known, const Find& find) {
  std::vector<ByHand> all;
  for (const std::string& name : names) {
    const std::vector<ByHand> found = find(name);
    if (found.empty())
      return refusal(
          fmt::format("the rig has no {} \"{}\": {}", of_what, name, mend_for_unknown(name, known, "it has none")));
    for (const ByHand& one : found) {
      const bool twice = std::any_of(all.begin(), all.end(), [&](const ByHand& other) {
        return other.what == one.what && other.index == one.index;
      });
      if (!twice) all.push_back(one);
    }
  }
  return all;
}

std::vector<std::string_view> names_of_fixtures(const Rig& rig) {
  std::vector<std::string_view> names;
  for (const Fixture& fixture : rig.fixtures) names.push_back(fixture.name);
  return names;
}

std::vector<std::string_view> names_of_points(const Rig& rig) {
  std::vector<std::string_view> names;
  for (const Point& point : rig.points) names.push_back(point.name);
  return names;
}

}  // namespace

Result<std::vector<ByHand>> fixtures_called(const Rig& rig, const std::vector<std::string>& names) {
  return all_called(names, "fixture", names_of_fixtures(rig),
                    [&](const std::string& name) { return fixtures_like(rig, name); });
}

Result<std::vector<ByHand>> points_called(const Rig& rig, const std::vector<std::string>& names) {
  return all_called(names, "point", names_of_points(rig),
                    [&](const std::string& name) { return points_like(rig, name); });
}

Result<std::vector<ByHand>> anything_called(const Rig& rig, const std::vector<std::string>& names) {
  std::vector<std::string_view> known = names_of_fixtures(rig);
  for (const std::string_view point : names_of_points(rig)) known.push_back(point);
  return all_called(names, "fixture or point", known, [&](const std::string& name) {
    std::vector<ByHand> found;
    for (const ByHand& one : fixtures_like(rig, name)) {
      for (const std::size_t f : one.whole_housing ? housing_of(rig, one.index) : std::vector{one.index})
        found.push_back({ByHand::What::level, f});
    }
    for (const ByHand& point : points_like(rig, name)) found.push_back(point);
    return found;
  });
}

Result<Devices> devices_called(const Rig& rig, const std::vector<std::string>& names) {
  std::vector<std::string_view> known = names_of_fixtures(rig);
  for (const Luxmeter& luxmeter : rig.luxmeters) known.push_back(luxmeter.name);
  std::vector<bool> fixture(rig.fixtures.size(), false), luxmeter(rig.luxmeters.size(), false);
  for (const std::string& name : names) {
    bool any = false;
    for (const ByHand& one : fixtures_like(rig, name)) {
      for (const std::size_t f : one.whole_housing ? housing_of(rig, one.index) : std::vector{one.index})
        fixture[f] = any = true;
    }
    for (std::size_t m = 0; m < luxmeter.size(); ++m)
      if (is_called(rig.luxmeters[m].name, name)) luxmeter[m] = any = true;
    if (!any)
      return refusal(fmt::format("the rig has no fixture or luxmeter \"{}\": {}", name,
                                 mend_for_unknown(name, known, "it has none")));
  }
  Devices devices;
  for (std::size_t f = 0; f < fixture.size(); ++f)
    if (fixture[f]) devices.fixtures.push_back(f);
  for (std::size_t m = 0; m < luxmeter.size(); ++m)
    if (luxmeter[m]) devices.luxmeters.push_back(m);
  return devices;
}

}  // namespace luxrig
