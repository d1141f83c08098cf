// The server's settings file.
#include "server/app/settings_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {

void try_input(Input input) {
  static InputFile file("settings.toml");
  server_app::Options options;
  if (server_app::apply_settings_file(file.write(as_text(input)), options))
    (void)server_app::check_options(options);
}

std::vector<std::string> seeds() {
  server_app::Options options;
  options.target_ms = 12.5;
  return {server_app::describe({}), server_app::describe(options),
          "# a comment\nthreads = 2 # cores\nquality = 0x55\nscene = '''atrium'''\n"};
}

}  // namespace macula::fuzz
