"""Writes the tables of src/guide/long_runs.md from the records of the long runs."""

import csv
import re
import sys
from collections import defaultdict

RECORD, RIGID, PAGE = sys.argv[1:4]
ROLES = ['an applied force', 'ground that moves', 'friction that varies', 'several surfaces', 'work of a drive']


def main():
    with open(RECORD, newline='', encoding='utf-8') as file:
        lines = [line for line in csv.reader(file) if line and line[0] != 'seed']
    with open(RIGID, newline='', encoding='utf-8') as file:
        runs = list(csv.reader(file))[1:]
    with open(PAGE, encoding='utf-8') as file:
        page = file.read()
    page = put(page, 'sweeps', sweeps([line for line in lines if line[0].isdigit()]) + before([line for line in lines if line[0] == 'before']))
    page = put(page, 'trials', trials([line for line in lines if not line[0]]))
    page = put(page, 'rigid', rigid(runs))
    with open(PAGE, 'w', encoding='utf-8') as file:
        file.write(page)


def put(page, name, text):
    return re.sub(rf'(<!-- {name}: begin.*?-->\n).*?(<!-- {name}: end)', lambda m: m[1] + text + m[2], page, flags=re.S)


def number(value):
    return f'{value:,}'


def sweeps(lines):
    """One row for each kind of scenes, over all seeds."""
    if not lines:
        return 'No run is stored.\n'
    kinds, failures = defaultdict(lambda: [0] * 12), []
    for line in lines:
        counts = [int(count) for count in line[2:14]]
        sums = kinds[line[1]]
        for column, count in enumerate(counts):
            sums[column] = max(sums[column], count) if column == 6 else sums[column] + count
        if line[14]:
            # The record has the scene too.
            found = line[14].split(';')[0].removeprefix('Test failed: ')
            failures.append(f'- seed {line[0]}, {line[1]}: {found}')
    total = [sum(sums[column] for sums in kinds.values()) for column in range(12)]
    total[6] = max(sums[6] for sums in kinds.values())
    text = '\n| scenes | number | steps | scenes refused | not whole | held by the limiter | slowest step |\n|---|---|---|---|---|---|---|\n'
    for name, sums in [*kinds.items(), ('**all**', total)]:
        part = [f'{100 * count / max(sums[1], 1):.2f} %' for count in (sums[3], sums[4])]
        text += f'| {name} | {number(sums[0])} | {number(sums[1])} | {number(sums[2])} | {part[0]} | {part[1]} | {number(sums[6])} |\n'
    seeds = sorted({int(line[0]) for line in lines})
    text += f'\nSeeds: {ranges(seeds)}. Steps with ' + ', '.join(f'{role}: {number(count)}' for role, count in zip(ROLES, total[7:])) + '.\n'
    frozen = [failure for failure in failures if 'frozen' in failure]
    if len(frozen) < len(failures):
        return text + '\n**Broken promises:**\n\n' + '\n'.join(failures) + '\n\n'
    text += f'\nIncreases of the energy: 0. Numbers that are not finite: 0. Panics: 0. Bodies left where they were: {len(frozen)}.\n\n'
    return text + ''.join(failure + '\n' for failure in frozen) + ('\n' if frozen else '')


def before(lines):
    """The sums of the versions before the present one, which the record has in one row."""
    return ''.join(
        f'Versions before this one: {number(int(line[3]))} steps of {number(int(line[2]))} scenes. Increases of the energy: 0. '
        f'Numbers that are not finite: 0. Panics: 0. Bodies left where they were: {line[14]}.\n\n'
        for line in lines
    )


def ranges(numbers):
    """1, 2, 3, 5 as `1 to 3, 5`."""
    parts = []
    for value in numbers:
        if parts and parts[-1][1] == value - 1:
            parts[-1][1] = value
        else:
            parts.append([value, value])
    return ', '.join(str(a) if a == b else f'{a} to {b}' for a, b in parts)


def trials(lines):
    if not lines:
        return 'No run is stored.\n'
    text = '\n| trial | steps | iterations a step | fallbacks | held by the limiter | slowest step | broken promise |\n|---|---|---|---|---|---|---|\n'
    for line in lines:
        counts = [int(count) for count in line[2:14]]
        steps = max(counts[1], 1)
        text += f'| {line[1]} | {number(counts[1])} | {counts[5] / steps:.2f} | {number(counts[3])} | {number(counts[4])} | {counts[6]} | {line[14] or "none"} |\n'
    return text + '\n'


def rigid(runs):
    """The largest deformations in the first 10,000 steps, in any window and in the last."""
    if not runs:
        return 'No run is stored.\n'
    text = '\n| method | steps | length, first | length, any | length, last | distance, first | distance, any | distance, last |\n|---|---|---|---|---|---|---|---|\n'
    for name, steps, *figures in runs:
        text += f'| {name} | {number(int(steps))} | ' + ' | '.join([*figures[0::2], *figures[1::2]]) + ' |\n'
    return text + '\n'


if __name__ == '__main__':
    main()
