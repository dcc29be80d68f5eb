"""What the pages say of an axis on CAN: their commands run as they are written, on the emulated drive."""
import re
import subprocess

from bench import Bench, case, require

COMMISSIONING = "firmware/targets/linux/COMMISSIONING.md"
MEASURING = "controller/identify/MEASURING.md"


@case
def the_dry_run_of_the_commissioning_checklist_goes_as_it_says(build):
    """Figures of a run in real time are not compared, zeros and words are."""
    ended = subprocess.run(["python3", "-B", "tests/package/page_commands.py", "--programs", f"{build}/sim/cli",
                            "--programs", f"{build}/firmware/targets/linux", "--page", COMMISSIONING, "--words"],
                           capture_output=True, text=True, timeout=600, check=False)
    require(ended.returncode == 0, ended.stdout + ended.stderr)
    return ended.stdout.strip().splitlines()[-1]


@case
def friction_is_measured_by_hand_as_the_page_says(build):
    """The script of the page, on the axis of the page, both ways."""
    with open(MEASURING, encoding="utf-8") as page:
        text = page.read()
    script = re.search(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    with open("/dev/shm/ramp.py", "w", encoding="utf-8") as file:
        file.write(script[1])
    said = [int(number) for number in re.search(r"breaks away at (\d+) per mille\nslides under (\d+)", text).groups()]
    with Bench(build) as b:
        made = b.start(b.command, "new", *re.search(r"breakaway new (.*) -o axis.toml", text)[1].split(), "-o",
                       "/dev/shm/by_hand.toml")
        require(made.end() == 0, made.output())
        b.drive("vcan0", scenario="/dev/shm/by_hand.toml")
        for push, direction in (("250", 1), ("-250", -1)):
            ramp = b.start("python3", "-B", "/dev/shm/ramp.py", "vcan0", "1", push)
            require(ramp.end() == 0, ramp.output())
            found = [int(number) for number in re.findall(r"(-?\d+) per mille", ramp.output())]
            require(abs(found[0] * direction - said[0]) <= 2, f"breaks away at {found[0]}, and the page says {said[0]}")
            require(abs(found[1] * direction - said[1]) <= 5, f"slides under {found[1]}, and the page says {said[1]}")
    return ", ".join(f"{number} per mille" for number in found)
