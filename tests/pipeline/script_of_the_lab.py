"""The laboratory of the tests in a process of its own: runs its pipeline, as the command line would."""

import importlib
import json
import sys
from pathlib import Path

if __name__ == "__main__":
    folder, options = Path(sys.argv[1]), json.loads(sys.argv[2])
    sys.path.insert(0, str(folder / "code"))
    module = importlib.import_module("lab")  # beside this script
    processes = importlib.import_module("vines.pipeline._processes")
    processes.WORTH_SECONDS = options.pop("worth", processes.WORTH_SECONDS)
    work = importlib.import_module("vines.pipeline._work")
    work.TARGET_SECONDS = options.pop("target", work.TARGET_SECONDS)
    if "shard" in options:
        options["shard"] = importlib.import_module("vines.pipeline").Shard.read(options["shard"])
    lab = object.__new__(module.Lab)
    lab.folder = folder
    lab.store = importlib.import_module("vines.store").Store(folder / "data")
    lab.register()
    stoppable = importlib.import_module("vines.cli._interrupt").stoppable
    errors = importlib.import_module("vines.errors")
    try:
        with stoppable("the same command goes on"):
            summary = lab.run(folder / "pipelines" / "toys.toml", **options)
    except errors.VinesError as error:
        print(f"vines: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    print(json.dumps({each.name: [each.state, each.wanted, each.new, each.failed] for each in summary.stages}))
