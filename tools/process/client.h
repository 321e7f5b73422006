#pragma once
/// What commands that talk to a running daemon share.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "core/result.h"

namespace luxrig {

/// Which daemon: on loopback.
struct ClientArguments {
  int port = 9620;
  bool json = false;
  std::optional<std::filesystem::path> token;  ///< of a daemon of another user, by the port
};
void add_client(CLI::App& command, ClientArguments& client);
/// The same without --json.
void add_client_without_json(CLI::App& command, ClientArguments& client);

/// Without the name of the cause, which says no more than the text. Returns the exit code.
int report_unreachable(const Fault& fault);
/// Asks it to do something and prints `done`, then what it answers; returns the exit code.
int post(const ClientArguments& arguments, const char* route, const std::string& body, const std::string& done,
         int wait_s = 5);

}  // namespace luxrig
