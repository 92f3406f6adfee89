"""The programs of `programs`, read: which files each is made of."""
import os

HERE = os.path.dirname(os.path.abspath(__file__))


def listed_programs(device):
    """{program: [names of each of its shaders]} of "gl" or "native", in the order of the list."""
    lists, found = {}, {}
    with open(os.path.join(HERE, "programs"), encoding="utf-8") as file:
        for line in file:
            words = [part for word in line.split() for part in lists.get(word, [word])]
            if not words or line.startswith("#"):
                continue
            if line.startswith("+"):
                lists[words[0]] = words[1:]
                continue
            devices, program, *names = words
            if devices not in ("gl", "native", "both"):
                raise SystemExit("shaders/programs: %s is no device" % devices)
            if devices in (device, "both"):
                found[program] = [part.split() for part in " ".join(names).split("|")]
    return found
