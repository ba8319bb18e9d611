// Pins: what pcphys was asked to write is written whole, or it says so and exits with another code than 0; a file
// that was there stays as it was until a whole one takes its place, and nothing else is left in its folder.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <set>

#include "command_support.h"

using namespace pcphys::test;

namespace {

const std::string program = PCPHYS_COMMAND;
const std::string short_run = "run balls --count 1 --steps 1 ";
const std::string endless_run = "run balls --count 1 --steps 1000000000 ";

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

bool is_json(const std::string& text) { return !Json::parse(text, nullptr, false).is_discarded(); }

}  // namespace

TEST_CASE("outputs: every sub-command says that standard output did not take its result") {
  const char* short_ones[] = {"run balls --count 1 --steps 1",
                              "run balls --count 1 --steps 1 --hash",
                              "run balls --count 1 --steps 1 --json -",
                              "run balls --count 1 --steps 1 --events -",
                              "plan balls",
                              "tables --steps 1",
                              "scenes",
                              "scenes --csv -",
                              "doctor",
                              "accuracy --list",
                              "accuracy A1 --dt 0.1",
                              "stability --list",
                              "compare balls --count 1 --steps 1 --peers none",
                              "wild --list",
                              "wild encounter --seed 1",
                              "--help",
                              "run --help",
                              "--version"};
  for (const std::string arguments : short_ones) {
    for (const char* stream : {" >/dev/full", " >&-"}) {
      CAPTURE(arguments + stream);
      const Ran ran = shell(program + " " + arguments + stream);
      CHECK(ran.code == 1);
      CHECK(ran.error.find("pcphys: Cannot write all of the result to standard output") != std::string::npos);
    }
  }
}

TEST_CASE("outputs: a file that needs no standard output is whole where all streams are closed") {
  Folder folder;
  const Ran ran = shell(program + " " + short_run + "--json " + folder.file("a.json") + " <&- >&- 2>&-");
  CHECK(ran.code == 0);
  CHECK(is_json(read_file(folder.file("a.json"))));
  const Ran text = shell(program + " scenes --csv " + folder.file("a.csv") + " <&- >&-");
  CHECK(text.code == 1);
  CHECK(read_file(folder.file("a.csv")).starts_with("name,default_count,"));
  CHECK(folder.names() == std::set<std::string>{"a.csv", "a.json"});
}

TEST_CASE("outputs: a pipe that nobody reads is an error, and the files are written") {
  Folder folder;
  const Ran ran = shell("{ sleep 0.3; " + program + " scenes --csv " + folder.file("a.csv") + "; echo $? >" +
                        folder.file("code") + "; } | true");
  CHECK(read_file(folder.file("code")) == "1\n");
  CHECK(ran.error.find("Broken pipe") != std::string::npos);
  CHECK(read_file(folder.file("a.csv")).ends_with("\"\n"));
}

TEST_CASE("outputs: what does not fit leaves the file that was there") {
  Folder folder;
  for (const char* option : {"--json", "--csv", "--events"}) {
    CAPTURE(std::string(option));
    write(folder.file("kept"), "kept");
    const std::string run = program + " run balls --count 60 --steps 100 " + option + " ";
    const Ran over = shell("ulimit -f 1; " + run + folder.file("kept"));
    CHECK(over.code == 1);
    CHECK(over.error.find("File too large") != std::string::npos);
    CHECK(read_file(folder.file("kept")) == "kept");
    CHECK(shell("ulimit -f 1; " + run + folder.file("new")).code == 1);
    CHECK(folder.names() == std::set<std::string>{"kept"});
  }
  CHECK(shell("ulimit -f 1; " + program + " run balls --poses --json - >" + folder.file("out")).code == 1);
}

TEST_CASE("outputs: a signal leaves the file that was there, and no other") {
  Folder folder;
  write(folder.file("kept"), "kept");
  for (const char* signal : {"HUP", "INT", "TERM", "KILL"}) {
    CAPTURE(std::string(signal));
    const std::string files = "--json " + folder.file("kept") + " --csv " + folder.file("new");
    const Ran ran = shell(std::string("timeout -s ") + signal + " 0.5 " + program + " " + endless_run + files);
    CHECK(ran.code != 0);
    CHECK(read_file(folder.file("kept")) == "kept");
    CHECK(folder.names() == std::set<std::string>{"kept"});
  }
}

TEST_CASE("outputs: two for one place are refused, however it is spelled") {
  Folder folder;
  const std::string old = folder.file("old");
  write(old, "kept");
  std::filesystem::create_hard_link(old, folder.file("hard"));
  std::filesystem::create_symlink("old", folder.file("soft"));
  std::filesystem::create_symlink("new", folder.file("dangling"));
  const std::string names[][2] = {{"old", "old"}, {"old", "./old"},     {"old", "hard"},     {"old", "soft"},
                                  {"new", "new"}, {"new", "./././new"}, {"new", "dangling"}, {"/dev/stdout", "-"}};
  struct Two {
    std::string sub_command, a, b;
  };
  const Two pairs[] = {{short_run, "--json ", " --csv "},
                       {short_run, "--events ", " --json "},
                       {"plan balls ", "--json ", " --csv "},
                       {"scenes ", "--json ", " --csv "},
                       {"wild encounter --count 1 ", "--csv ", " --shrink-to "}};
  for (const auto& pair : names) {
    const std::string first = pair[0], second = pair[1];
    CAPTURE(first + " " + second);
    for (const Two& two : pairs) {
      const std::string in_folder = "cd " + std::filesystem::path(old).parent_path().string() + "; ";
      const Ran ran = shell(in_folder + program + " " + two.sub_command + two.a + first + two.b + second);
      CHECK(ran.code == 2);
      CHECK(ran.error.find(" is asked for by --") != std::string::npos);
    }
  }
  CHECK(read_file(old) == "kept");
  CHECK_FALSE(std::filesystem::exists(folder.file("new")));
}

TEST_CASE("outputs: a file is replaced as what it was: behind its link, with its permissions") {
  Folder folder;
  write(folder.file("old"), "old");
  chmod(folder.file("old").c_str(), 0640);
  std::filesystem::create_symlink("old", folder.file("soft"));
  std::filesystem::create_symlink("new", folder.file("dangling"));
  CHECK(command("scenes --json " + folder.file("soft") + " --csv " + folder.file("dangling")).code == 0);
  CHECK(std::filesystem::is_symlink(folder.file("soft")));
  CHECK(std::filesystem::is_symlink(folder.file("dangling")));
  CHECK(is_json(read_file(folder.file("old"))));
  struct stat status {};
  REQUIRE(stat(folder.file("old").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
  CHECK(shell("umask 027; " + program + " scenes --json " + folder.file("fresh")).code == 0);
  REQUIRE(stat(folder.file("fresh").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
  CHECK(folder.names() == std::set<std::string>{"dangling", "fresh", "new", "old", "soft"});
}

TEST_CASE("outputs: devices and pipes are written directly, and standard output by any name is standard output") {
  Folder folder;
  CHECK(command(short_run + "--json /dev/null --csv /dev/null --hash").code == 0);
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK(is_json(command(short_run + "--json /dev/stdout").out));
  CHECK(is_json(shell(program + " " + short_run + "--json /dev/stdout | cat").out));
  CHECK(is_json(command(short_run + "--hash --json /dev/stderr").error));
  const std::string own = folder.file("own");
  CHECK(shell(program + " " + short_run + "--json " + own + " >" + own).code == 0);
  CHECK(is_json(read_file(own)));
  const std::string pipe = folder.file("pipe");
  CHECK(is_json(shell("mkfifo " + pipe + "; cat " + pipe + " & " + program + " scenes --json " + pipe + "; wait").out));
  CHECK(std::filesystem::is_fifo(pipe));
}

TEST_CASE("outputs: names as long as a folder takes them") {
  Folder folder;
  CHECK(command(short_run + "--hash --json " + folder.file(std::string(255, 'a'))).code == 0);
  const Ran longer = command(short_run + "--hash --json " + folder.file(std::string(256, 'a')));
  CHECK(longer.code == 1);
  CHECK(longer.error.find("File name too long") != std::string::npos);
}
