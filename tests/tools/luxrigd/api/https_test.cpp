// The API within TLS: the cookie, and a certificate that is renewed while the daemon runs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/tools/http/made_certificate.h"
#include "tools/luxrigd/api/accounts.h"
#include "tools/luxrigd/api/http_api.h"

namespace luxrig {
namespace {

using test::made_certificate;
using test::status_of;
using test::TlsWire;

class HttpsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder);
    where.http_port = 0;
    where.accounts_file = folder / "accounts.json";
    where.tls_certificate_file = folder / "page.pem";
    where.tls_key_file = folder / "page-key.pem";
    Accounts accounts;
    accounts.people = {{"anna", Role::operate, *password_hash("correct horse")}};
    ASSERT_TRUE(write_accounts(where.accounts_file, accounts));
    put(made_certificate("DNS:rig.example"));
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  void put(const test::MadeCertificate& made) const {
    std::ofstream(where.tls_certificate_file) << made.certificate;
    std::ofstream(where.tls_key_file) << made.key;
    ::chmod(where.tls_key_file.c_str(), 0600);
  }
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "luxrig_https";
  DaemonSpec where;
};

std::string request(const std::string& method, const std::string& path, const std::string& headers,
                    const std::string& body = "") {
  return method + " " + path +
         " HTTP/1.1\r\nConnection: close\r\nHost: rig.example\r\nContent-Type: application/json\r\n" + headers +
         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

TEST_F(HttpsTest, APersonLogsInByHttpsAndTheCookieGoesByHttpsAlone) {
  HttpHandlers handlers;
  handlers.status = [] { return std::string("{}"); };
  HttpApi api(std::move(handlers), "/nonexistent");
  const auto port = api.start(where);
  ASSERT_TRUE(port) << port.error().detail;
  EXPECT_EQ(api.one_time_address().rfind("https://rig.example:" + std::to_string(*port) + "/?open=", 0), 0u)
      << api.one_time_address();
  const std::string in = TlsWire(*port).ask(request("POST", "/api/login", "Origin: https://rig.example\r\n",
                                                    R"({"name":"anna","password":"correct horse"})"));
  EXPECT_EQ(status_of(in), 200) << in;
  const std::size_t at = in.find("Set-Cookie: ");
  ASSERT_NE(at, std::string::npos) << in;
  const std::string cookie = in.substr(at + 12, in.find("\r\n", at) - at - 12);
  EXPECT_NE(cookie.find("HttpOnly; SameSite=Strict; Path=/; Secure"), std::string::npos) << cookie;
  const std::string known = "Cookie: " + cookie.substr(0, cookie.find(';')) + "\r\n";
  EXPECT_EQ(status_of(TlsWire(*port).ask(request("GET", "/api/status", known))), 200);
  EXPECT_EQ(status_of(TlsWire(*port).ask(request("GET", "/api/status", ""))), 401);
}

TEST_F(HttpsTest, ARenewedCertificateIsTakenUpAndADamagedOneIsNot) {
  HttpApi api({}, "/nonexistent");
  const auto port = api.start(where);
  ASSERT_TRUE(port) << port.error().detail;
  const auto within = [](const std::function<bool()>& done) {
    for (int i = 0; i < 3000 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return done();
  };
  const std::string first = TlsWire(*port).fingerprint();
  put(made_certificate("DNS:rig.example"));
  EXPECT_TRUE(within([&] { return TlsWire(*port).fingerprint() != first; }));
  const std::string second = TlsWire(*port).fingerprint();
  std::ofstream(where.tls_certificate_file) << "not one";
  EXPECT_TRUE(within([&] { return api.problem().find("is no certificate") != std::string::npos; })) << api.problem();
  EXPECT_EQ(TlsWire(*port).fingerprint(), second);
}

TEST_F(HttpsTest, AKeyThatOthersMayReadIsRefused) {
  ASSERT_EQ(::chmod(where.tls_key_file.c_str(), 0644), 0);
  HttpApi api({}, "/nonexistent");
  const auto port = api.start(where);
  ASSERT_FALSE(port);
  EXPECT_NE(port.error().detail.find("chmod 640 it"), std::string::npos) << port.error().detail;
}

}  // namespace
}  // namespace luxrig
