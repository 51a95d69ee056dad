"""Counts the mutants of the library that its tests find.

A mutant is a copy of the source with one change, as `cargo mutants` lists them: another operator,
a function that returns a constant, an arm that never matches. A test that fails kills it.

All chosen mutants are written into one copy of the source, and the environment selects one
(tests/mutants/weave). So the test programs are compiled once for all of them. Each test runs once
beforehand, to record which mutants it reaches and how long it takes. A mutant is then tried with
the tests that reach it, the quickest first, the stored bits last.
"""

import argparse
import csv
import hashlib
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter, defaultdict

# What the promises rest on, tried whole.
GROUPS = {
    'certificate': r'src/outcome(\.rs|/)',
    'limiter': r'src/integrator/(energy_limit(\.rs|/)|flight_rounding\.rs)',
    'merge': r'src/ensemble/(tally|ranges|histogram|interval)\.rs',
    'contract': r'src/contract(\.rs|/)',
}
# Of a line of the result file. The last is the source that the mutant was tried on; a line of an older version has none.
COLUMNS = ['group', 'mutant', 'result', 'by', 'tests', 'source']
# Results of a mutant that no test finds.
LEFT = ['survived', 'not reached']


def main():
    asked = arguments()
    folder = os.path.join(os.environ.get('CARGO_TARGET_DIR', 'target'), 'mutants', asked.name)
    os.makedirs(folder, exist_ok=True)
    chosen = choose(asked)
    kept, others = kept_lines(asked)
    tried_before = sum(mutant['name'] in kept for mutant in chosen)
    print(f'{len(chosen)} mutants, {tried_before} of them tried before', flush=True)
    if others:
        print(f'{others} lines of {asked.result} are of another source or of other tests' + (', and do not count' if asked.diff else ''), flush=True)
    left = [mutant for mutant in chosen if mutant['name'] not in kept or asked.again and kept[mutant['name']][2] in LEFT]
    if left and not asked.report:
        refused, programs = build(folder, chosen, asked)
        tests = trace(folder, programs, asked)
        try_all(left, refused, tests, kept, asked)
    report(chosen, asked)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--sample', type=int, default=0, help='mutants drawn from all folders of src in proportion')
    parser.add_argument('--seed', type=int, default=1, help='seed of the sample and of the order')
    parser.add_argument('--only', action='append', default=[], choices=sorted(GROUPS), help='all mutants of a group')
    parser.add_argument('--diff', help='mutants of what changed since a commit')
    parser.add_argument('--programs', help='test programs of tests/mutants/tests, with commas; all by default')
    parser.add_argument('--again', action='store_true', help='try those again that no test has found, for instance with other programs')
    parser.add_argument('--longest', type=float, default=8.0, help='longest test that is run, seconds of the processor')
    parser.add_argument('--minutes', type=float, default=1e9, help='time after which no other mutant is begun')
    parser.add_argument('--result', default='target/mutants/result.csv', help='file that is appended to; what it holds is not tried again')
    parser.add_argument('--name', default='all', help='name of the build folder')
    parser.add_argument('--write', action='store_true', help='write the counts into tests/mutants')
    parser.add_argument('--report', action='store_true', help='only count what the result file holds')
    asked = parser.parse_args()
    asked.source = source()
    return asked


# --- which mutants ---------------------------------------------------------------------------------

def choose(asked):
    """The mutants in the order in which they are tried: the sample, then the groups, each in random order, so that a part is a sample too."""
    listed = mutants_of(asked)
    draw = random.Random(asked.seed)
    chosen = {}
    for mutant in sample(listed, asked.sample, draw):
        chosen[mutant['name']] = mutant | {'group': 'sample'}
    of_groups = [mutant | {'group': group} for group in asked.only for mutant in listed if re.match(GROUPS[group], mutant['file'])]
    draw.shuffle(of_groups)
    for mutant in of_groups:
        # One of the sample counts in both.
        chosen.setdefault(mutant['name'], mutant)
    if asked.diff:
        chosen = {mutant['name']: mutant | {'group': 'diff'} for mutant in listed}
    for number, mutant in enumerate(chosen.values()):
        mutant['id'] = number + 1
    return list(chosen.values())


def mutants_of(asked):
    command = ['cargo', 'mutants', '--list', '--json']
    if asked.diff:
        diff = os.path.join('target', 'mutants', 'diff')
        os.makedirs(os.path.dirname(diff), exist_ok=True)
        with open(diff, 'w', encoding='utf-8') as file:
            subprocess.run(['git', 'diff', asked.diff, '--', 'src'], check=True, stdout=file)
        command += ['--in-diff', diff]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout or '[]')


def folder_of(mutant):
    """Folder of src with its file: `src/body/coin.rs` and `src/body.rs` are both of `body`."""
    return mutant['file'].split('/')[1].removesuffix('.rs')


def sample(listed, count, draw):
    """As many of each folder as its part of all mutants, at least one, in random order."""
    if not count:
        return []
    strata = defaultdict(list)
    for mutant in listed:
        strata[folder_of(mutant)].append(mutant)
    drawn = []
    for name in sorted(strata):
        share = max(1, round(count * len(strata[name]) / len(listed)))
        drawn += draw.sample(strata[name], min(share, len(strata[name])))
    draw.shuffle(drawn)
    return drawn


def source():
    """Hash of what decides a result: the source of the library, and the programs of the tests with all files that they include."""
    listed = ['git', 'ls-files', '--cached', '--others', '--exclude-standard', 'src/*.rs', 'tests/mutants/tests', 'tests/mutants/Cargo.*']
    left = subprocess.check_output(listed, text=True).split()
    found = set()
    while left:
        path = left.pop()
        if path in found or not os.path.isfile(path):
            continue
        found.add(path)
        if path.endswith('.rs') and not path.startswith('src/'):
            left += included(path)
    text = hashlib.sha256()
    for path in sorted(found):
        with open(path, 'rb') as file:
            content = file.read()
        text.update(f'{path}\0{len(content)}\0'.encode() + content)
    return text.hexdigest()[:16]


def included(path):
    """Files that a test names: modules, also by `#[path]`, and texts. Those that do not exist are other places of the same module."""
    with open(path, encoding='utf-8') as file:
        text = file.read()
    folder, inner = os.path.dirname(path), path.removesuffix('.rs')
    names = re.findall(r'\b(?:path = |include(?:_str|_bytes)?!\(\s*)"([^"]+)"', text)
    for module in re.findall(r'^\s*(?:pub(?:\([^)]*\))? )?mod (\w+);', text, re.M):
        names += [f'{module}.rs', f'{module}/mod.rs']
        names += [os.path.relpath(f'{inner}/{module}{end}', folder) for end in ['.rs', '/mod.rs']]
    return [os.path.normpath(os.path.join(folder, name)) for name in names]


# --- one build for all -----------------------------------------------------------------------------

def build(folder, chosen, asked):
    """Writes and compiles the mutants. Returns those that do not compile, and the programs."""
    stamp, ready = stamp_of(chosen, asked.source), os.path.join(folder, 'ready')
    if os.path.exists(ready):
        with open(ready, encoding='utf-8') as file:
            before = json.load(file)
        if before['stamp'] == stamp:
            refused = {int(number): result for number, result in before['refused'].items()}
            return refused, compiled(os.path.join(folder, 'tree'), folder, asked)
    tool = compiled_weaver()
    refused = {}
    known = remembered(folder, asked)
    for mutant in chosen:
        if mutant['name'] in known:
            refused[mutant['id']] = 'not compiled'
    while True:
        tree = written(folder, tool, [m for m in chosen if m['id'] not in refused], refused)
        wrong = errors(tree, folder)
        if not wrong:
            break
        print(f'{len(wrong)} mutants do not compile', flush=True)
        refused |= dict.fromkeys(wrong, 'not compiled')
        remember(folder, asked, [mutant['name'] for mutant in chosen if mutant['id'] in wrong])
    with open(ready, 'w', encoding='utf-8') as file:
        json.dump({'stamp': stamp, 'refused': refused}, file)
    return refused, compiled(tree, folder, asked)


def stamp_of(chosen, of_source):
    """Hash of the mutants, the source and the tests, to know whether the copy is still the one that is wanted."""
    return hashlib.sha256(json.dumps([chosen, of_source]).encode()).hexdigest()


def remembered(folder, asked):
    """Names of the mutants of this source that an earlier run of this folder could not compile."""
    path = os.path.join(folder, f'refused_{asked.source}')
    if not os.path.exists(path):
        return set()
    with open(path, encoding='utf-8') as file:
        return set(file.read().splitlines())


def remember(folder, asked, names):
    with open(os.path.join(folder, f'refused_{asked.source}'), 'a', encoding='utf-8') as file:
        file.writelines(name + '\n' for name in names)


def compiled_weaver():
    target = os.path.abspath('target/mutants/weave')
    subprocess.run(['cargo', 'build', '-q', '--manifest-path', 'tests/mutants/weave/Cargo.toml', '--target-dir', target], check=True)
    return os.path.join(target, 'debug', 'tumble_weave')


def written(folder, tool, mutants, refused):
    """A copy of the source and the tests with the mutants in it."""
    tree = os.path.join(folder, 'tree')
    shutil.rmtree(tree, ignore_errors=True)
    for part in ['src', 'tests', 'assets', 'examples/web/src']:
        shutil.copytree(part, os.path.join(tree, part), ignore=shutil.ignore_patterns('target', 'corpus'))
    listed = os.path.join(folder, 'mutants.json')
    with open(listed, 'w', encoding='utf-8') as file:
        json.dump(mutants, file)
    left_out = subprocess.run([tool, listed, tree], check=True, capture_output=True, text=True).stdout
    refused |= dict.fromkeys(map(int, left_out.split()), 'not written')
    shutil.copy('tests/mutants/switch.rs', os.path.join(tree, 'src/mutant_switch.rs'))
    library = os.path.join(tree, 'src/lib.rs')
    with open(library, encoding='utf-8') as file:
        text = file.read()
    with open(library, 'w', encoding='utf-8') as file:
        file.write(f'#![allow(warnings)]\n{text}\nmod mutant_switch;\nuse mutant_switch::mutant;\n')
    return tree


def cargo(tree, folder, *command):
    manifest = os.path.join(tree, 'tests/mutants/Cargo.toml')
    target = os.path.abspath(os.path.join(folder, 'build'))
    command = ['cargo', *command, '--manifest-path', manifest, '--target-dir', target, '--message-format=json', '-j1']
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    return run.returncode, [json.loads(line) for line in run.stdout.splitlines() if line.startswith('{')], run.stderr


def errors(tree, folder):
    """Mutants that the compiler refuses: the last one written before the place of each error."""
    code, messages, text = cargo(tree, folder, 'check', '--lib')
    if code == 0:
        return set()
    wrong = set()
    for message in messages:
        message = message.get('message', {})
        if message.get('level') != 'error':
            continue
        for span in message.get('spans', []):
            wrong |= written_before(tree, span)
    if not wrong:
        raise SystemExit(f'the copy does not compile:\n{text}')
    return wrong


def written_before(tree, span):
    path = os.path.join(tree, 'tests/mutants', span['file_name'])
    if not os.path.exists(path):
        return set()
    with open(path, encoding='utf-8') as file:
        line = file.read().split('\n')[span['line_start'] - 1]
    ids = [int(found[1]) for found in re.finditer(r'crate::mutant\((\d+)\)', line) if found.start() < span['column_end']]
    return set(ids[-1:])


def compiled(tree, folder, asked):
    wanted = asked.programs.split(',') if asked.programs else None
    names = wanted or ['lib'] + sorted(file.removesuffix('.rs') for file in os.listdir('tests/mutants/tests'))
    programs = {}
    for name in sorted(names, key=lambda name: (name == 'bits', name != 'lib', name)):
        start = time.time()
        which = ['--lib'] if name == 'lib' else ['--test', name]
        code, messages, text = cargo(tree, folder, 'test', '--no-run', *which)
        if code:
            rendered = [m['message']['rendered'] for m in messages if m.get('message', {}).get('level') == 'error']
            raise SystemExit('\n'.join(rendered) or text)
        programs[name] = [m['executable'] for m in messages if m.get('executable')][-1]
        print(f'{name}: compiled in {time.time() - start:.0f} s', flush=True)
    return programs


# --- which tests reach which mutants ---------------------------------------------------------------

def environment(**more):
    return os.environ | {'PROPTEST_MAX_SHRINK_ITERS': '0', 'RUST_BACKTRACE': '0', 'TUMBLE_OUTCOMES': '200', 'TUMBLE_SWEEP_STEPS': '4000'} | more


def run(program, test, seconds, tree, **more):
    """Runs one test for at most some seconds of the processor. Returns its exit code, None if it takes longer."""
    limit = math.ceil(seconds)
    process = subprocess.Popen([program, '--exact', test, '--test-threads=1', '-q'], env=environment(**more), cwd=tree,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
    try:
        # A program that waits takes no time of the processor.
        code = process.wait(timeout=30 * limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None
    return None if code in (-signal.SIGXCPU, -signal.SIGKILL) else code


def processor_seconds():
    """Time that the programs that have ended took of the processor."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def trace(folder, programs, asked):
    """Runs each test by itself. Returns its name, time, and the mutants that it reaches."""
    tree = os.path.abspath(os.path.join(folder, 'tree/tests/mutants'))
    record = os.path.abspath(os.path.join(folder, f'reached_{os.getpid()}'))
    tests = []
    for name, program in programs.items():
        listed = subprocess.run([program, '--list', '--format=terse'], capture_output=True, text=True, cwd=tree).stdout
        for test in re.findall(r'^(.*): test$', listed, re.M):
            open(record, 'w').close()
            start = processor_seconds()
            # The stored bits are run however long they take: they see most of what the laws do not.
            code = run(program, test, 120 if name == 'bits' else asked.longest, tree, TUMBLE_MUTANT_TRACE=record)
            if code != 0:
                print(f'left out: {name} {test}: ' + ('too long' if code is None else 'fails in the copy'), flush=True)
                continue
            with open(record, encoding='utf-8') as file:
                reached = set(map(int, file.read().split()))
            tests.append({'program': name, 'path': program, 'test': test, 'seconds': processor_seconds() - start, 'reached': reached, 'tree': tree})
    # Laws first, so that a kill by the stored bits alone is known as such.
    tests.sort(key=lambda test: (test['program'] == 'bits', test['seconds']))
    print(f'{len(tests)} tests, {sum(test["seconds"] for test in tests):.0f} s', flush=True)
    return tests


# --- trying ----------------------------------------------------------------------------------------

def try_all(mutants, refused, tests, kept, asked):
    start = time.time()
    with open(asked.result, 'a', newline='', encoding='utf-8') as file:
        writer = csv.writer(file, lineterminator='\n')
        for number, mutant in enumerate(mutants):
            if time.time() - start > asked.minutes * 60:
                print(f'stopped after {number} of {len(mutants)}')
                return
            result, by, count = refused.get(mutant['id']), '', 0
            if not result:
                result, by, count = tried(mutant['id'], tests)
                # Other tests have reached it before.
                if result == 'not reached' and mutant['name'] in kept:
                    result = kept[mutant['name']][2]
            line = {'group': mutant['group'], 'mutant': mutant['name'], 'result': result, 'by': by, 'tests': count, 'source': asked.source}
            writer.writerow([line[column] for column in COLUMNS])
            file.flush()
            if number % 20 == 0:
                print(f'{number} of {len(mutants)}, {time.time() - start:.0f} s', flush=True)


def tried(number, tests):
    """What happens to a mutant: the result, the test that found it, and the number of tests run."""
    reaching = [test for test in tests if number in test['reached']]
    if not reaching:
        return 'not reached', '', 0
    for count, test in enumerate(reaching, 1):
        seconds = 5 + 10 * test['seconds']
        code = run(test['path'], test['test'], seconds, test['tree'], TUMBLE_MUTANT=str(number))
        name = f'{test["program"]}: {test["test"]}'
        if code is None:
            return 'timed out', name, count
        if code != 0:
            return ('killed by bits' if test['program'] == 'bits' else 'killed'), name, count
    return 'survived', '', len(reaching)


# --- counting --------------------------------------------------------------------------------------

def kept_lines(asked):
    """Lines of the result file by mutant, and how many lines are of another source or of other tests.

    A change is judged by what it is now: for `--diff` these others do not count. For a sample or a group, which takes hours and is continued, they do.
    """
    kept, others = {}, 0
    if not os.path.exists(asked.result):
        return kept, others
    with open(asked.result, newline='', encoding='utf-8') as file:
        for line in csv.reader(file):
            if line[len(COLUMNS) - 1:] != [asked.source]:
                others += 1
                if asked.diff:
                    continue
            # Of a mutant that is tried again, what finds it counts.
            if line[1] not in kept or kept[line[1]][2] in LEFT:
                kept[line[1]] = line
    return kept, others


def wilson(count, total):
    """Wilson's interval of 95 % of a fraction."""
    z, fraction = 1.959964, count / total
    middle = fraction + z * z / (2 * total)
    half = z * math.sqrt(fraction * (1 - fraction) / total + z * z / (4 * total * total))
    return [(middle + sign * half) / (1 + z * z / total) for sign in [-1, 1]]


def report(chosen, asked):
    kept, _ = kept_lines(asked)
    groups = ['diff'] if asked.diff else ['sample'] * bool(asked.sample) + asked.only
    lines = ['| group | mutants | tried | not compiled | a test fails | takes too long | stored bits alone | survived | not reached | found, of those that compile |', '|' + '---|' * 10]
    lines += [row(group, chosen, kept) for group in groups]
    print('\n'.join(lines))
    left = [m['name'] for m in chosen if m['name'] in kept and kept[m['name']][2] in LEFT]
    if asked.write:
        write(lines, left, kept, asked)
    if asked.diff and left:
        sys.exit('not found by any test:\n' + '\n'.join(left))


def row(group, chosen, kept):
    """Counts of a group. A mutant of the sample that is of a group counts in both."""
    of_group = [m for m in chosen if m['group'] == group or re.match(GROUPS.get(group, '$'), m['file'])]
    results = Counter(kept[m['name']][2] for m in of_group if m['name'] in kept)
    compile_not = results['not compiled'] + results['not written']
    viable = sum(results.values()) - compile_not
    found = results['killed'] + results['timed out'] + results['killed by bits']
    fraction = 'none'
    if viable:
        low, high = wilson(found, viable)
        fraction = f'{100 * found / viable:.1f} % [{100 * low:.1f}, {100 * high:.1f}]'
    counts = [len(of_group), sum(results.values()), compile_not, results['killed'], results['timed out'],
              results['killed by bits'], results['survived'], results['not reached']]
    return '| ' + ' | '.join(map(str, [group, *counts, fraction])) + ' |'


def write(lines, left, kept, asked):
    """The table into the README of the mutants, and those that are left with their reasons into a list."""
    readme = 'tests/mutants/README.md'
    with open(readme, encoding='utf-8') as file:
        text = file.read()
    # A row of a group that was not asked for stays.
    new = {line.split('|')[1].strip() for line in lines}
    rows = [line for line in re.search(r'<!-- mutants: begin.*?-->(.*?)<!--', text, re.S)[1].splitlines() if line]
    lines = lines + [line for line in rows[2:] if line.split('|')[1].strip() not in new]
    text = re.sub(r'(<!-- mutants: begin.*?-->\n).*?(<!-- mutants: end)', lambda m: m[1] + '\n' + '\n'.join(lines) + '\n\n' + m[2], text, flags=re.S)
    with open(readme, 'w', encoding='utf-8') as file:
        file.write(text)
    with open('tests/mutants/reasons.txt', encoding='utf-8') as file:
        known = [line.rstrip('\n').split('\t') for line in file if '\t' in line]
    by_reason = defaultdict(list)
    for entry in sorted([f'{name} ({kept[name][2]})' for name in left] + others_left(kept, asked)):
        reason = next((reason for pattern, reason in known if re.search(pattern, entry)), 'Not read yet')
        by_reason[reason].append(entry)
    with open('tests/mutants/left.txt', 'w', encoding='utf-8') as file:
        file.write('Mutants that no test finds, by the reason of reasons.txt; written by `bash .ci/mutants.sh --report --write`.\n')
        for reason, entries in sorted(by_reason.items(), key=lambda item: item[0] == 'Not read yet'):
            file.write(f'\n{reason}: {len(entries)}\n' + ''.join(f'  {entry}\n' for entry in entries))


def others_left(kept, asked):
    """Entries of the list of the groups that were not asked for, without those that have been tried again."""
    others = [GROUPS[group] for group in GROUPS if group not in asked.only]
    with open('tests/mutants/left.txt', encoding='utf-8') as file:
        entries = [line.strip() for line in file if line.startswith('  ')]
    tried_before = [entry for entry in entries if entry.rsplit(' (', 1)[0] not in kept]
    return [entry for entry in tried_before if any(re.match(pattern, entry) for pattern in others)]


if __name__ == '__main__':
    main()
