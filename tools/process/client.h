#pragma once
/// Shared parts of the commands that talk to a running daemon.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"

namespace luxrig {

/// The daemon: on loopback.
struct ClientArguments {
  int port = 9620;
  bool json = false;
  std::optional<std::filesystem::path> token;  ///< token file of another user's daemon, by the port
};
void add_client(CLI::App& command, ClientArguments& client);
/// The same without --json.
void add_client_without_json(CLI::App& command, ClientArguments& client);

/// Prints the text without the name of the cause, which adds nothing. Returns the exit code.
int report_unreachable(const Fault& fault);
/// Sends a request, prints `done` and then the answer; returns the exit code.
int post(const ClientArguments& arguments, const char* route, const std::string& body, const std::string& done,
         int wait_s = 5);

}  // namespace luxrig
