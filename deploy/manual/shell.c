#include "deploy/manual/shell.h"

#include <string.h>

#define MOST_DEFAULT_BYTES 48 /* a longer default would hide the summary of the next option */

/* Writes the text in one line. Characters in `escaped` get a backslash; a quotation mark ends and
 * restarts the quoted text. */
static void put_text(FILE *out, const char *text, size_t length, const char *escaped)
{
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '\'')
            fputs("'\\'", out);
        else if (strchr(escaped, text[i]))
            fputc('\\', out);
        fputc(text[i] == '\n' ? ' ' : text[i], out);
    }
}

/* Writes the first part of a help text, up to a parenthesis, a semicolon, a colon or the end of the
 * sentence; then the default, "(default: ...)", if there is a single and short one. */
static void put_summary(FILE *out, const char *help, const char *escaped)
{
    static const char *const ends[] = {" (", "\n(", "; ", ";\n", ": ", ":\n", ". ", ".\n"};
    static const char mark[] = "(default: ";
    size_t length = strlen(help);
    for (size_t i = 0; i < sizeof(ends) / sizeof(*ends); i++) {
        const char *end = strstr(help, ends[i]);
        if (end && (size_t)(end - help) < length)
            length = (size_t)(end - help);
    }
    if (length > 0 && help[length - 1] == '.')
        length--;
    put_text(out, help, length, escaped);
    const char *preset = strstr(help, mark);
    size_t n = preset ? strcspn(preset + 1, "()") + 2 : 0;
    if (preset && preset[n - 1] == ')' && n <= MOST_DEFAULT_BYTES && !strstr(preset + 1, mark)) {
        fputc(' ', out);
        put_text(out, preset, n, escaped);
    }
}

/* ---- bash ---- */

/* Writes the option names of a command: "--size --eye ...". */
static void bash_names(FILE *out, const struct shell_command *command)
{
    for (size_t i = 0; i < command->n_options; i++) {
        fprintf(out, "%s--%s", i ? " " : "", command->options[i].name);
        if (command->options[i].letter)
            fprintf(out, " -%c", command->options[i].letter);
    }
}

static void bash_option(FILE *out, const struct shell_command *command,
                        const struct shell_option *option)
{
    if (option->value == SHELL_FLAG)
        return;
    const char *name = command->name ? command->name : "";
    fprintf(out, "        %s:--%s", name, option->name);
    if (option->letter)
        fprintf(out, " | %s:-%c", name, option->letter);
    fputs(") ", out);
    if (option->value == SHELL_FILE)
        fputs("files=-f", out);
    else if (option->value == SHELL_FOLDER)
        fputs("files=-d", out);
    else
        fprintf(out, "words='%s'", option->words ? option->words : "");
    fputs(" is_value=1 ;;\n", out);
}

void shell_bash(FILE *out, const struct shell_program *program)
{
    bool has_commands = program->commands[0].name != NULL;
    fprintf(
        out,
        "# bash completion of %s. Bash cuts words at '=' and ':': they are put together again.\n"
        "_%s() {\n"
        "    local tokens=() glue= word cur prev= command= words= files= is_value= i\n"
        "    for ((i = 1; i <= COMP_CWORD; i++)); do\n"
        "        word=${COMP_WORDS[i]}\n"
        "        if [[ $word == = && ${tokens[*]: -1} == --* ]]; then\n"
        "            ((i == COMP_CWORD)) && tokens+=('')\n"
        "        elif [[ ${#tokens[@]} -gt 0 && ( $word == [:=]* || $glue ) ]]; then\n"
        "            tokens[-1]+=$word\n"
        "            [[ $word == *[:=] ]] && glue=1 || glue=\n"
        "        else\n"
        "            tokens+=(\"$word\")\n"
        "        fi\n"
        "    done\n"
        "    cur=${tokens[*]: -1}\n"
        "    ((${#tokens[@]} > 1)) && prev=${tokens[*]: -2:1}\n",
        program->name, program->name);
    if (has_commands)
        fputs("    ((${#tokens[@]} > 1)) && command=${tokens[0]}\n", out);
    fputs("    case $command:$prev in\n", out);
    for (size_t c = 0; c < program->n_commands; c++)
        for (size_t i = 0; i < program->commands[c].n_options; i++)
            bash_option(out, &program->commands[c], &program->commands[c].options[i]);
    fputs("    esac\n"
          "    if [[ ! $is_value ]]; then\n"
          "        case $command in\n",
          out);
    for (size_t c = 0; c < program->n_commands; c++) {
        const struct shell_command *command = &program->commands[c];
        fprintf(out, "        %s) words='", command->name ? command->name : "''");
        bash_names(out, command);
        fprintf(out, "'%s ;;\n", command->takes_files ? " files=-f" : "");
    }
    if (has_commands) {
        fputs("        '') words='", out);
        for (size_t c = 0; c < program->n_commands; c++)
            fprintf(out, "%s ", program->commands[c].name);
        fputs("help --help --version' ;;\n", out);
    }
    fprintf(out,
            "        esac\n"
            "        [[ $cur == -* ]] && files= || { [[ $files ]] && words=; }\n"
            "    fi\n"
            "    mapfile -t COMPREPLY < <(compgen ${files:+$files} ${words:+-W \"$words\"} -- "
            "\"$cur\")\n"
            "    [[ $files || $words ]] || COMPREPLY=()\n"
            "    local behind=${cur##*:}\n"
            "    [[ $cur == *:* ]] && COMPREPLY=(\"${COMPREPLY[@]#\"${cur%%\"$behind\"}\"}\")\n"
            "    [[ $files ]] && compopt -o filenames 2>/dev/null\n"
            "    return 0\n"
            "}\n"
            "complete -F _%s %s\n",
            program->name, program->name);
}

/* ---- zsh ---- */

static void zsh_option(FILE *out, const struct shell_option *option)
{
    static const char special[] = "[]:\\";
    if (option->letter)
        fprintf(out, "            '(-%c --%s)'{-%c,--%s}'[", option->letter, option->name,
                option->letter, option->name);
    else
        fprintf(out, "            '*--%s[", option->name);
    put_summary(out, option->help, special);
    fputc(']', out);
    if (option->value == SHELL_FILE)
        fputs(":file:_files", out);
    else if (option->value == SHELL_FOLDER)
        fputs(":folder:_files -/", out);
    else if (option->value == SHELL_VALUE) {
        fputs(":value:", out);
        if (option->words)
            fputc('(', out);
        for (const char *c = option->words; c && *c; c++)
            fprintf(out, "%s%c", *c == ':' ? "\\" : "", *c);
        if (option->words)
            fputc(')', out);
    }
    fputs("' \\\n", out);
}

static void zsh_arguments(FILE *out, const struct shell_command *command)
{
    fputs("        _arguments -s -S \\\n", out);
    for (size_t i = 0; i < command->n_options; i++)
        zsh_option(out, &command->options[i]);
    fprintf(out, "            %s\n", command->takes_files ? "'*:file:_files'" : "&& ret=0");
}

void shell_zsh(FILE *out, const struct shell_program *program)
{
    bool has_commands = program->commands[0].name != NULL;
    fprintf(out, "#compdef %s\n_%s() {\n    local ret=1\n", program->name, program->name);
    if (has_commands) {
        fputs("    local -a commands\n    commands=(\n", out);
        for (size_t c = 0; c < program->n_commands; c++) {
            fprintf(out, "        '%s:", program->commands[c].name);
            put_summary(out, program->commands[c].summary, ":\\");
            fputs("'\n", out);
        }
        fputs("    )\n"
              "    if ((CURRENT == 2)); then\n"
              "        _describe command commands\n"
              "        return\n"
              "    fi\n"
              "    local command=$words[2]\n"
              "    shift words\n"
              "    ((CURRENT--))\n",
              out);
    } else {
        fputs("    local command=''\n", out);
    }
    fputs("    case $command in\n", out);
    for (size_t c = 0; c < program->n_commands; c++) {
        fprintf(out, "    %s)\n", program->commands[c].name ? program->commands[c].name : "''");
        zsh_arguments(out, &program->commands[c]);
        fputs("        ;;\n", out);
    }
    fprintf(out,
            "    esac\n"
            "    return ret\n"
            "}\n"
            "if [ \"$funcstack[1]\" = \"_%s\" ]; then\n"
            "    _%s \"$@\"\n"
            "else\n"
            "    compdef _%s %s\n"
            "fi\n",
            program->name, program->name, program->name, program->name);
}

/* ---- fish ---- */

static void fish_option(FILE *out, const char *program, const char *command,
                        const struct shell_option *option)
{
    fprintf(out, "complete -c %s", program);
    if (command)
        fprintf(out, " -n '__fish_seen_subcommand_from %s'", command);
    fprintf(out, " -l %s", option->name);
    if (option->letter)
        fprintf(out, " -s %c", option->letter);
    if (option->value == SHELL_FILE)
        fputs(" -r -F", out);
    else if (option->value == SHELL_FOLDER)
        fputs(" -x -a '(__fish_complete_directories)'", out);
    else if (option->value == SHELL_VALUE)
        fputs(" -x", out);
    if (option->words)
        fprintf(out, " -a '%s'", option->words);
    fputs(" -d '", out);
    put_summary(out, option->help, "\\");
    fputs("'\n", out);
}

void shell_fish(FILE *out, const struct shell_program *program)
{
    for (size_t c = 0; c < program->n_commands; c++) {
        const struct shell_command *command = &program->commands[c];
        if (command->name) {
            fprintf(out, "complete -c %s -f -n __fish_use_subcommand -a %s -d '", program->name,
                    command->name);
            put_summary(out, command->summary, "\\");
            fputs("'\n", out);
        }
        if (!command->takes_files && command->name)
            fprintf(out, "complete -c %s -f -n '__fish_seen_subcommand_from %s'\n", program->name,
                    command->name);
        else if (!command->takes_files)
            fprintf(out, "complete -c %s -f\n", program->name);
        for (size_t i = 0; i < command->n_options; i++)
            fish_option(out, program->name, command->name, &command->options[i]);
    }
    if (program->commands[0].name)
        fprintf(out,
                "complete -c %s -f -n __fish_use_subcommand -l help -d 'lists the commands'\n"
                "complete -c %s -f -n __fish_use_subcommand -l version -d 'says the version'\n",
                program->name, program->name);
}
