#include "tools/http/message.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tools/http/json_body.h"

namespace luxrig {
namespace {

TEST(HttpMessage, ParametersAreDecoded) {
  HttpRequest request;
  request.query = "a=1&camera=a%20b%2F+c&bad=%4&empty=&last";
  EXPECT_EQ(request.parameter("a"), "1");
  EXPECT_EQ(request.parameter("camera"), "a b/ c");
  EXPECT_EQ(request.parameter("bad"), std::nullopt);
  EXPECT_EQ(request.parameter("empty"), "");
  EXPECT_EQ(request.parameter("last"), "");
  EXPECT_EQ(request.parameter("none"), std::nullopt);
}

TEST(HttpMessage, StaticFilesComeOnlyFromTheirFolder) {
  std::string name = (std::filesystem::temp_directory_path() / "luxrig-static-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  std::filesystem::create_directories(folder / "web" / "assets");
  std::ofstream(folder / "secret.txt") << "secret";
  std::ofstream(folder / "web" / ".hidden") << "secret";
  std::ofstream(folder / "web" / "index.html") << "<p>page";
  std::ofstream(folder / "web" / "assets" / "a-1_2.js") << "1";
  const std::string web = (folder / "web").string();
  EXPECT_EQ(static_file(web, "/").body, "<p>page");
  EXPECT_EQ(static_file(web, "/").content_type, "text/html; charset=utf-8");
  EXPECT_EQ(static_file(web, "/assets/a-1_2.js").content_type, "text/javascript");
  for (const char* path : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/assets", "/none",
                           "/.hidden", "//etc/passwd/../../secret.txt", "", "secret.txt", "/..", "/assets\\..\\x"}) {
    EXPECT_EQ(static_file(web, path).status, 404) << path;
  }
  EXPECT_EQ(static_file("/nonexistent", "/").status, 404);
  std::filesystem::remove_all(folder);
}

TEST(JsonBody, IsReadUpToALimitedDepth) {
  EXPECT_EQ(json_body(R"({"a":[1,{"b":"]]]]"}]})")["a"][0], 1);
  EXPECT_TRUE(json_body(std::string(16, '[') + std::string(16, ']')).is_array());
  EXPECT_TRUE(json_body(std::string(17, '[') + std::string(17, ']')).is_discarded());
  EXPECT_TRUE(json_body("{").is_discarded());
  EXPECT_EQ(json_body('"' + std::string(100, '[') + "\\\"" + '"').get<std::string>().size(), 101u);
}

TEST(HttpMessage, ARouteWithANameInBracesHasPathsWithOneMorePart) {
  EXPECT_TRUE(path_is_of("/api/jobs", "/api/jobs"));
  EXPECT_FALSE(path_is_of("/api/jobs/", "/api/jobs"));
  for (const char* path : {"/api/jobs/7", "/api/jobs/{id}", "/api/jobs/.."})
    EXPECT_TRUE(path_is_of(path, "/api/jobs/{id}")) << path;
  for (const char* path : {"/api/jobs", "/api/jobs/", "/api/jobs/7/8", "/api/jobs/7/", "/api/job/7", "/", ""})
    EXPECT_FALSE(path_is_of(path, "/api/jobs/{id}")) << path;
  EXPECT_EQ(last_part("/api/jobs/7"), "7");
  EXPECT_EQ(last_part("7"), "7");
}

HttpRequest from(const std::string& address, HttpHeaders headers) {
  HttpRequest request;
  request.from = address;
  request.headers = std::move(headers);
  hear_proxy(request);
  return request;
}

TEST(HttpMessage, AProxyOnThisComputerIsBelievedAndNobodyElse) {
  const HttpHeaders proxied = {
      {"host", "rig.example"}, {"x-forwarded-for", "10.0.0.7"}, {"x-forwarded-proto", "https"}};
  const HttpRequest request = from("127.0.0.1", proxied);
  EXPECT_EQ(request.from, "10.0.0.7");
  EXPECT_TRUE(request.secure && request.proxied);
  EXPECT_FALSE(foreign_request(request, false)) << "the proxy's own name";
  const HttpRequest elsewhere = from("10.0.0.9", proxied);
  EXPECT_EQ(elsewhere.from, "10.0.0.9");
  EXPECT_FALSE(elsewhere.secure || elsewhere.proxied);
  EXPECT_TRUE(foreign_request(elsewhere, false));
  EXPECT_FALSE(from("127.0.0.1", {{"host", "localhost"}, {"x-forwarded-proto", "https"}}).secure) << "not by the proxy";
}

TEST(HttpMessage, OfForwardedAddressesTheOneThatTheProxySawCounts) {
  EXPECT_EQ(from("127.0.0.1", {{"x-forwarded-for", "1.2.3.4, 10.0.0.7"}}).from, "10.0.0.7");
  EXPECT_EQ(from("::1", {{"x-forwarded-for", "1.2.3.4"}, {"x-forwarded-for", "2001:DB8::7"}}).from, "2001:db8::7");
  for (const char* none : {"", "unknown", "10.0.0.7:80", "10.0.0.7,", "_hidden"})
    EXPECT_EQ(from("127.0.0.1", {{"x-forwarded-for", none}}).from, "127.0.0.1") << none;
}

TEST(HttpMessage, ThroughAProxyTheOriginHasToBeTheOneThatWasAsked) {
  const auto refused = [](const char* origin) {
    return foreign_request(from("127.0.0.1", {{"host", "127.0.0.1:9620"},
                                              {"x-forwarded-host", "rig.example"},
                                              {"x-forwarded-for", "10.0.0.7"},
                                              {"x-forwarded-proto", "https"},
                                              {"origin", origin}}),
                           false)
        .has_value();
  };
  EXPECT_FALSE(refused("https://rig.example"));
  for (const char* other : {"http://rig.example", "https://evil.example", "http://127.0.0.1:9620", "null"})
    EXPECT_TRUE(refused(other)) << other;
}

}  // namespace
}  // namespace luxrig
