#pragma once
/// HTTP on loopback: the page, the status, and the few things a client may ask, for those who may. Routes: README.md
/// beside this file.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// What the daemon answers with. Called from the server's threads; each must be safe to call from any thread.
struct HttpHandlers {
  std::function<std::string()> status;     ///< JSON
  std::function<std::string()> universes;  ///< JSON
  std::function<std::string()> room_json;
  std::function<std::string()> room_png;  ///< empty: there is no scene to draw
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
  /// Reads the rig file again, whole or not at all.
  std::function<Checked<std::string>()> reload;
};

class HttpApi {
 public:
  HttpApi(HttpHandlers handlers, std::filesystem::path web_folder);
  ~HttpApi();

  /// Binds 127.0.0.1:port (0 = any) and this user's socket for it, leaves the token beside that, and serves on threads
  /// of its own. Returns the port.
  [[nodiscard]] Result<int> start(int port);
  /// Opens one browser, once, within ten minutes.
  [[nodiscard]] std::string one_time_address();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
