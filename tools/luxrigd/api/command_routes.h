#pragma once
/// What a client may ask of the daemon: from the bodies of requests to calls of it.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/http/server.h"

namespace luxrig {

/// What the daemon answers with. Called from the server's threads; each must be safe to call from any thread.
struct HttpHandlers {
  std::function<std::string()> status;     ///< JSON
  std::function<std::string()> universes;  ///< JSON
  std::function<std::string()> room_json;  ///< empty: not drawn yet
  std::function<std::string()> room_png;   ///< empty: there is no scene to draw
  std::function<Result<void>(bool on)> blackout;
  /// Shows for so many seconds which fixture it is.
  std::function<Result<void>(const std::string& fixture, double seconds)> identify;
  /// Heads of these names, or all when there are none.
  std::function<Result<void>(const std::vector<std::string>& fixtures)> park;
  std::function<void()> hand_back;  ///< desks that wait for it get the light
  /// What a person should know about it all the same, in lines; empty: nothing.
  std::function<Checked<std::string>(const std::string& plan_json)> apply;
  /// By hand, until released or for so many seconds. Names may have * and ?. Gives a line for a person.
  std::function<Result<std::string>(const std::vector<std::string>& fixtures, double level,
                                    std::optional<double> for_s)>
      level;
  std::function<Result<std::string>(const std::vector<std::string>& points, double lux, std::optional<double> for_s)>
      goal;
  /// Fixtures and points; none: all.
  std::function<Result<std::string>(const std::vector<std::string>& names)> release;
  /// Takes fixtures and luxmeters of these names out of the show, or back in. Gives the risk, in lines.
  std::function<Result<std::string>(const std::vector<std::string>& names, bool on)> bypass;
  /// Reads the rig file again, whole or not at all.
  std::function<Checked<std::string>()> reload;
};

/// The handlers are copied.
[[nodiscard]] std::vector<HttpRoute> command_routes(HttpHandlers handlers);

/// An answer that no cache keeps.
[[nodiscard]] HttpResponse json_answer(std::string json);

}  // namespace luxrig
