#pragma once
/// HTTP on loopback: the page, the status, and the few things a client may ask. Routes: README.md beside this file.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// What the daemon answers with. Called from the server's threads; each must be safe to call from any thread.
struct HttpHandlers {
  std::function<std::string()> status;     ///< JSON
  std::function<std::string()> universes;  ///< JSON
  std::string room_json;
  std::string room_png;
  std::function<Result<void>(bool on)> blackout;
  /// Shows for so many seconds which fixture it is.
  std::function<Result<void>(const std::string& fixture, double seconds)> identify;
  /// Heads of these names, or all when there are none.
  std::function<Result<void>(const std::vector<std::string>& fixtures)> park;
  std::function<void()> hand_back;  ///< desks that wait for it get the light
  std::function<Checked<void>(const std::string& plan_json)> apply;
};

class HttpApi {
 public:
  HttpApi(HttpHandlers handlers, std::filesystem::path web_folder);
  ~HttpApi();

  /// Binds 127.0.0.1:port (0 = any) and serves on threads of its own. Returns the port.
  [[nodiscard]] Result<int> start(int port);
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
