// The API's file follows from the table of routes, and the server answers each route of it.
#include "tools/luxrigd/api/openapi.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/folders.h"
#include "tools/luxrigd/api/route_table.h"

namespace luxrig {
namespace {

TEST(OpenApi, TheCheckedInFileIsWhatTheTableGives) {
  std::ifstream in(test::source_folder() / "tools/luxrigd/openapi.json", std::ios::binary);
  const std::string file((std::istreambuf_iterator<char>(in)), {});
  EXPECT_TRUE(file == openapi_json())
      << "write it anew: cmake --build --preset release --target openapi, and look at the difference";
}

TEST(OpenApi, EachRouteOfTheServerIsInTheFile) {
  const auto file = nlohmann::json::parse(openapi_json());
  std::set<std::string> in_file, of_server, ids;
  for (const auto& [path, methods] : file["paths"].items())
    for (const auto& [method, operation] : methods.items()) {
      in_file.insert(method + " " + path);
      ids.insert(operation["operationId"].get<std::string>());
    }
  for (const HttpRoute& route : http_routes({})) {
    std::string method = route.method;
    for (char& c : method) c = static_cast<char>(std::tolower(c));
    of_server.insert(method + " " + route.path);
  }
  EXPECT_EQ(in_file, of_server);
  EXPECT_EQ(ids.size(), in_file.size()) << "two operations have one name";
}

TEST(OpenApi, OnlyTheSessionAndTheLoginAnswerAnybody) {
  for (const ApiRoute& route : route_table()) {
    const std::string what = std::string(route.method) + route.path;
    EXPECT_EQ(route.role == Role::anybody, what == "GET/api/session" || what == "POST/api/login") << what;
  }
}

TEST(OpenApi, WhoMayLookChangesNothingAndBlackoutIsForWhoOperates) {
  for (const ApiRoute& route : route_table()) {
    const std::string what = std::string(route.method) + route.path;
    if (route.role == Role::look)
      EXPECT_TRUE(std::string(route.method) == "GET" || what == "POST/api/logout" || what == "POST/api/preview")
          << what;
    if (what == "POST/api/blackout") EXPECT_TRUE(route.role == Role::operate && route.urgent);
  }
}

}  // namespace
}  // namespace luxrig
