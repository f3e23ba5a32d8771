#include "cli/failures.h"

#include <filesystem>
#include <new>

#include "burnish/error.h"
#include "cli/commands.h"
#include "cli/console.h"

namespace burnish {

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
        return {kCannotWrite, one_line(error.what())};
    } catch (const std::exception& error) {
        return {kDefect, one_line(std::string("a defect of the program: ") + error.what())};
    }
}

}  // namespace burnish
