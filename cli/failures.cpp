#include "cli/failures.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string_view>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"

namespace burnish {

namespace {

/// "out/a.exr: No space left on device"; without a file the reason alone.
std::string file_and_reason(const std::filesystem::filesystem_error& error) {
    const std::string file = error.path1().string(), reason = error.code().message();
    return file.empty() ? reason : file + ": " + reason;
}

/// Whether no thread could be begun: std::thread says so by a code, oneTBB in words.
bool is_of_thread(const std::exception& error) {
    if (const auto* of_system = dynamic_cast<const std::system_error*>(&error))
        return of_system->code() == std::errc::resource_unavailable_try_again;
    return std::string_view(error.what()).find("pthread_create") != std::string_view::npos;
}

}  // namespace

void print(const std::string& text) {
    if (std::fputs(text.c_str(), stdout) == EOF || std::fflush(stdout) != 0)
        throw UnprintedLine(errno, std::generic_category());
}

Failure current_failure() {
    try {
        throw;
    } catch (const BatchFailed& failed) {
        return {failed.code, failed.what()};
    } catch (const UsageError& error) {
        return {kBadUsage, one_line(error.what())};
    } catch (const OutputError& error) {
        return {kCannotWrite, one_line(error.what())};
    } catch (const ResourceError& error) {
        return {kRefused, one_line(error.what())};
    } catch (const Error& error) {
        return {kBadInput, one_line(error.what())};
    } catch (const std::bad_alloc&) {
        return {
            kRefused,
            "there is not enough memory for this scene and these sizes: a smaller --size or fewer "
            "samples per pixel of the derivative take less"};
    } catch (const std::filesystem::filesystem_error& error) {
        return {kCannotWrite, one_line(file_and_reason(error))};
    } catch (const std::exception& error) {
        if (is_of_thread(error))
            return {kRefused, one_line(std::string("the system refuses a thread: ") + error.what() +
                                       " (see ulimit -u)")};
        return {kDefect, one_line(std::string("a defect of the program: ") + error.what())};
    }
}

}  // namespace burnish
